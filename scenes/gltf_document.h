// scenes/gltf_document: the container of a glTF or GLB file: its JSON, its buffers and images. Internal to the
// importer.
//
// tinygltf turns the JSON into structures. Buffers and images are kept away from it: it would read them from anywhere,
// copy them, and take their sizes on trust.
#pragma once

#include <tiny_gltf.h>

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/asset_folder.h"
#include "scenes/import.h"

namespace sheaf::scenes {

using Bytes = std::vector<unsigned char>;
using ByteSpan = std::span<const unsigned char>;

class GltfDocument {
 public:
  /// Throws Error: kUnsupported for version 1 and for required extensions that sheaf does not know, else kBadInput.
  explicit GltfDocument(ImportSource source);

  /// Without buffers, images, animations and skins. Indices in it are not checked.
  const tinygltf::Model& model() const { return model_; }
  const std::string& name() const { return name_; }
  bool hasSkins() const { return has_skins_; }

  /// The bytes of a buffer view, unpacked if they are packed by EXT_meshopt_compression. Throws Error for an index or a
  /// range that does not exist, or a buffer that cannot be read. The span lives as long as the document.
  ByteSpan view(int buffer_view);

  /// The bytes of an image file. Throws Error.
  std::string imageFile(int image);

  [[noreturn]] void fail(std::string_view reason) const { refuse(name_, reason); }

 private:
  struct Buffer {
    std::string uri;
    bool has_uri = false;
    std::uint64_t size = 0;
    bool loaded = false;
    Bytes bytes;
  };
  struct Image {
    std::string uri;
    int buffer_view = -1;
  };
  struct PackedView {
    std::uint64_t buffer = 0, offset = 0, size = 0, stride = 0, count = 0;
    std::string mode, filter;
  };

  std::string_view splitContainer(std::string_view bytes);
  void parse(std::string_view json_text);
  void readStructure(std::string_view stripped_json);
  ByteSpan bufferRange(std::uint64_t buffer, std::uint64_t offset, std::uint64_t size);
  void loadBuffer(std::size_t index);
  Bytes unpack(const PackedView& view, int buffer_view);
  Bytes decodeDataUri(const std::string& uri, std::string_view what) const;

  std::string name_;
  AssetFolder folder_;
  Bytes glb_chunk_;
  bool is_glb_ = false;
  bool has_skins_ = false;
  tinygltf::Model model_;
  std::vector<Buffer> buffers_;
  std::vector<Image> images_;
  std::map<int, PackedView> packed_views_;
  std::map<int, Bytes> unpacked_views_;
};

}  // namespace sheaf::scenes
