// scenes/gltf_materials: glTF's materials, textures and samplers. Internal to the importer.
#pragma once

#include <map>
#include <string>
#include <utility>

#include "scenes/gltf_document.h"

namespace sheaf::scenes {

class GltfMaterials {
 public:
  GltfMaterials(GltfDocument& document, Scene& scene) : document_(document), scene_(scene) {}

  /// The number of a glTF material in scene.materials, where it is put when it is first asked for. -1 = glTF's default.
  /// flat  the mesh has no normals
  /// Throws Error if there is no such material. Textures that cannot be used are a warning.
  std::uint32_t number(int gltf_material, bool flat);

  /// Which TEXCOORD_n the base colour texture reads; -1 = no texture.
  int texcoordSet(int gltf_material) const;

 private:
  const tinygltf::Material* find(int gltf_material) const;
  Material convert(const tinygltf::Material& source);
  TextureUse convertTexture(const tinygltf::TextureInfo& info);
  std::int32_t imageNumber(int image);
  void warn(std::string_view text);

  GltfDocument& document_;
  Scene& scene_;
  std::map<std::pair<int, bool>, std::uint32_t> numbers_;
  std::map<int, std::int32_t> image_numbers_;
};

}  // namespace sheaf::scenes
