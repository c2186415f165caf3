#include "scenes/gltf_document.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

namespace sheaf::scenes {
namespace {

using nlohmann::json;

constexpr std::uint64_t kMost = std::uint64_t{1} << 48;  // no sum of two of these overflows
constexpr int kDeepestNesting = 64;

constexpr std::array<std::string_view, 5> kKnownExtensions = {"KHR_materials_unlit", "KHR_texture_transform",
                                                              "KHR_lights_punctual", "KHR_mesh_quantization",
                                                              "EXT_meshopt_compression"};

std::uint32_t littleEndian32(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = (value << 8) | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

const json* member(const json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto it = object.find(key);
  return it == object.end() ? nullptr : &*it;
}

std::uint64_t unsignedMember(const json& object, const char* key, std::uint64_t fallback) {
  const json* value = member(object, key);
  return value != nullptr && value->is_number_unsigned() ? std::min(value->get<std::uint64_t>(), kMost) : fallback;
}

std::string stringMember(const json& object, const char* key) {
  const json* value = member(object, key);
  return value != nullptr && value->is_string() ? value->get<std::string>() : std::string();
}

// Takes an array out of the document; empty if there is none.
json takeArray(json& root, const char* key) {
  const auto it = root.find(key);
  if (it == root.end()) return json::array();
  json array = std::move(*it);
  root.erase(it);
  return array.is_array() ? array : json::array();
}

// nlohmann's own text is "[json.exception.parse_error.101] parse error at line 1, column 2: ...".
std::string reasonOf(const json::exception& e) {
  const std::string_view text = e.what();
  const std::size_t bracket = text.find("] ");
  return std::string(bracket == std::string_view::npos ? text : text.substr(bracket + 2));
}

// Whether brackets nest so deeply that recursive readers of the document could leave their stack. Asked beforehand: the
// parser's own callback makes it take time with the square of an array's length.
bool nestsTooDeeply(std::string_view text) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') in_string = !in_string;
    if (in_string) {
      if (c == '\\') ++i;
    } else if (c == '[' || c == '{') {
      if (++depth > kDeepestNesting) return true;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return false;
}

}  // namespace

GltfDocument::GltfDocument(ImportSource source) : name_(source.name), folder_(source.path) {
  const std::string_view json_text = splitContainer(source.bytes);
  try {
    parse(json_text);
  } catch (const json::exception& e) {
    fail(fmt::format("JSON: {}", reasonOf(e)));
  }
}

// The JSON text; the binary chunk of a GLB is kept.
std::string_view GltfDocument::splitContainer(std::string_view bytes) {
  if (!bytes.starts_with("glTF")) {
    if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
    return bytes;
  }
  constexpr std::size_t kHeader = 12, kChunkHeader = 8;
  is_glb_ = true;
  if (bytes.size() < kHeader + kChunkHeader) fail("GLB: the file ends within its header");
  if (const std::uint32_t version = littleEndian32(bytes, 4); version != 2)
    refuseUnsupported(name_, fmt::format("GLB version {} is not supported (2 is)", version));
  const std::uint32_t length = littleEndian32(bytes, 8);
  if (length > bytes.size() || length < kHeader + kChunkHeader)
    fail(fmt::format("GLB: the header promises {} bytes, the file has {}", length, bytes.size()));
  bytes = bytes.substr(0, length);
  const std::uint32_t json_size = littleEndian32(bytes, kHeader);
  if (bytes.substr(kHeader + 4, 4) != "JSON") fail("GLB: the first chunk is not JSON");
  if (json_size > bytes.size() - kHeader - kChunkHeader) fail("GLB: the JSON chunk is longer than the file");
  const std::string_view json_text = bytes.substr(kHeader + kChunkHeader, json_size);
  const std::string_view rest = bytes.substr(kHeader + kChunkHeader + json_size);
  if (rest.size() >= kChunkHeader && rest.substr(4, 4) == std::string_view("BIN\0", 4)) {
    const std::uint32_t size = littleEndian32(rest, 0);
    if (size > rest.size() - kChunkHeader) fail("GLB: the BIN chunk is longer than the file");
    const std::string_view chunk = rest.substr(kChunkHeader, size);
    glb_chunk_.assign(chunk.begin(), chunk.end());
  }
  return json_text;
}

void GltfDocument::parse(std::string_view json_text) {
  if (nestsTooDeeply(json_text)) fail("JSON is nested too deeply");
  json root = json::parse(json_text);
  if (!root.is_object()) fail("is not a glTF file: no JSON object");
  const json* asset = member(root, "asset");
  const std::string version = asset == nullptr ? std::string() : stringMember(*asset, "version");
  if (version.empty()) fail("is not a glTF file: it has no asset.version");
  if (!version.starts_with("2.")) refuseUnsupported(name_, fmt::format("glTF version {} is not supported", version));
  for (const json& extension : takeArray(root, "extensionsRequired")) {
    const std::string required = extension.is_string() ? extension.get<std::string>() : extension.dump();
    if (std::find(kKnownExtensions.begin(), kKnownExtensions.end(), required) == kKnownExtensions.end())
      refuseUnsupported(name_, fmt::format("requires the extension {}, which is not supported", required));
  }
  for (const json& b : takeArray(root, "buffers"))
    buffers_.push_back(
        {stringMember(b, "uri"), member(b, "uri") != nullptr, unsignedMember(b, "byteLength", 0), false, {}});
  for (const json& i : takeArray(root, "images"))
    images_.push_back({stringMember(i, "uri"), static_cast<int>(std::min<std::uint64_t>(
                                                   unsignedMember(i, "bufferView", UINT32_MAX), 0x7FFFFFFF))});
  has_skins_ = !takeArray(root, "skins").empty();
  root.erase("animations");
  if (const json* views = member(root, "bufferViews"); views != nullptr && views->is_array())
    for (std::size_t v = 0; v < views->size(); ++v) {
      const json* extensions = member((*views)[v], "extensions");
      const json* packed = extensions == nullptr ? nullptr : member(*extensions, "EXT_meshopt_compression");
      if (packed == nullptr) continue;
      packed_views_[static_cast<int>(v)] = {
          unsignedMember(*packed, "buffer", kMost), unsignedMember(*packed, "byteOffset", 0),
          unsignedMember(*packed, "byteLength", 0), unsignedMember(*packed, "byteStride", 0),
          unsignedMember(*packed, "count", 0),      stringMember(*packed, "mode"),
          stringMember(*packed, "filter")};
    }
  readStructure(root.dump());
}

void GltfDocument::readStructure(std::string_view stripped_json) {
  if (stripped_json.size() > std::numeric_limits<unsigned>::max()) fail("the JSON is too large");
  tinygltf::TinyGLTF reader;
  std::string error, warning;
  bool read = false;
  try {
    read = reader.LoadASCIIFromString(&model_, &error, &warning, stripped_json.data(),
                                      static_cast<unsigned>(stripped_json.size()), "");
  } catch (const json::exception& e) {
    fail(fmt::format("JSON: {}", reasonOf(e)));
  }
  if (!read) fail(error.substr(0, error.find('\n')));
}

Bytes GltfDocument::decodeDataUri(const std::string& uri, std::string_view what) const {
  Bytes bytes;
  std::string mime_type;
  if (!tinygltf::IsDataURI(uri) || !tinygltf::DecodeDataURI(&bytes, mime_type, uri, 0, false))
    fail(fmt::format("{}: the data: URI cannot be decoded", what));
  return bytes;
}

void GltfDocument::loadBuffer(std::size_t index) {
  Buffer& buffer = buffers_[index];
  if (buffer.loaded) return;
  const std::string what = fmt::format("buffer {}", index);
  if (buffer.uri.starts_with("data:")) {
    buffer.bytes = decodeDataUri(buffer.uri, what);
    buffer.uri = {};
  } else if (buffer.has_uri) {
    try {
      const std::string bytes = folder_.read(percentDecoded(buffer.uri));
      buffer.bytes.assign(bytes.begin(), bytes.end());
    } catch (const Error& e) {
      fail(fmt::format("{}: {}", what, e.what()));
    }
  } else if (is_glb_ && index == 0) {
    buffer.bytes = std::move(glb_chunk_);
  } else {
    fail(fmt::format("{} has no uri", what));
  }
  if (buffer.bytes.size() < buffer.size)
    fail(fmt::format("{} is to have {} bytes, there are {}", what, buffer.size, buffer.bytes.size()));
  buffer.loaded = true;
}

ByteSpan GltfDocument::bufferRange(std::uint64_t buffer, std::uint64_t offset, std::uint64_t size) {
  if (buffer >= buffers_.size()) fail(fmt::format("buffer {} does not exist, there are {}", buffer, buffers_.size()));
  loadBuffer(static_cast<std::size_t>(buffer));
  const Bytes& bytes = buffers_[static_cast<std::size_t>(buffer)].bytes;
  if (offset > bytes.size() || size > bytes.size() - offset)
    fail(fmt::format("a buffer view of {} bytes at {} reaches past the {} bytes of buffer {}", size, offset,
                     bytes.size(), buffer));
  return ByteSpan(bytes).subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(size));
}

ByteSpan GltfDocument::view(int buffer_view) {
  if (buffer_view < 0 || static_cast<std::size_t>(buffer_view) >= model_.bufferViews.size())
    fail(fmt::format("buffer view {} does not exist, there are {}", buffer_view, model_.bufferViews.size()));
  if (const auto packed = packed_views_.find(buffer_view); packed != packed_views_.end()) {
    const auto [it, is_new] = unpacked_views_.try_emplace(buffer_view);
    if (is_new) it->second = unpack(packed->second, buffer_view);
    return it->second;
  }
  const tinygltf::BufferView& v = model_.bufferViews[static_cast<std::size_t>(buffer_view)];
  if (v.buffer < 0) fail(fmt::format("buffer view {} has no buffer", buffer_view));
  return bufferRange(static_cast<std::uint64_t>(v.buffer), v.byteOffset, v.byteLength);
}

// The decoders check the packed bytes themselves; what they assert about sizes is checked here.
Bytes GltfDocument::unpack(const PackedView& v, int buffer_view) {
  const std::string what = fmt::format("buffer view {}: EXT_meshopt_compression", buffer_view);
  const ByteSpan packed = bufferRange(v.buffer, v.offset, v.size);
  const bool attributes = v.mode == "ATTRIBUTES";
  const bool stride_fits =
      attributes ? v.stride % 4 == 0 && v.stride > 0 && v.stride <= 256 : v.stride == 2 || v.stride == 4;
  if (!stride_fits || (v.mode == "TRIANGLES" && v.count % 3 != 0))
    fail(fmt::format("{}: mode '{}' with stride {} and count {}", what, v.mode, v.stride, v.count));
  // Vertex data shrink to 1/64 at best: 4 bytes for 256 values of a byte. Indices need a byte per triangle.
  constexpr std::uint64_t kBestRatio = 64;
  if (v.count > kMost / 256 || v.count * v.stride > kBestRatio * (packed.size() + 256))
    fail(fmt::format("{}: {} elements cannot be in {} bytes", what, v.count, packed.size()));
  const auto count = static_cast<std::size_t>(v.count);
  const auto stride = static_cast<std::size_t>(v.stride);
  Bytes out(count * stride);
  int status = -1;
  if (attributes)
    status = meshopt_decodeVertexBuffer(out.data(), count, stride, packed.data(), packed.size());
  else if (v.mode == "TRIANGLES")
    status = meshopt_decodeIndexBuffer(out.data(), count, stride, packed.data(), packed.size());
  else if (v.mode == "INDICES")
    status = meshopt_decodeIndexSequence(out.data(), count, stride, packed.data(), packed.size());
  else
    fail(fmt::format("{}: unknown mode '{}'", what, v.mode));
  if (status != 0) fail(fmt::format("{}: the data are damaged", what));
  if (v.filter == "OCTAHEDRAL" && (stride == 4 || stride == 8))
    meshopt_decodeFilterOct(out.data(), count, stride);
  else if (v.filter == "QUATERNION" && stride == 8)
    meshopt_decodeFilterQuat(out.data(), count, stride);
  else if (v.filter == "EXPONENTIAL")
    meshopt_decodeFilterExp(out.data(), count, stride);
  else if (!v.filter.empty() && v.filter != "NONE")
    fail(fmt::format("{}: filter '{}' with stride {}", what, v.filter, stride));
  return out;
}

std::string GltfDocument::imageFile(int image) {
  if (image < 0 || static_cast<std::size_t>(image) >= images_.size())
    fail(fmt::format("image {} does not exist, there are {}", image, images_.size()));
  const Image& i = images_[static_cast<std::size_t>(image)];
  if (i.uri.empty()) {
    const ByteSpan bytes = view(i.buffer_view);
    return {bytes.begin(), bytes.end()};
  }
  if (!i.uri.starts_with("data:")) return folder_.read(percentDecoded(i.uri));
  const Bytes bytes = decodeDataUri(i.uri, fmt::format("image {}", image));
  return {bytes.begin(), bytes.end()};
}

}  // namespace sheaf::scenes
