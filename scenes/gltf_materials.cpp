#include "scenes/gltf_materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sheaf::scenes {
namespace {

const tinygltf::Value* transformOf(const tinygltf::TextureInfo& info) {
  const auto it = info.extensions.find("KHR_texture_transform");
  return it == info.extensions.end() || !it->second.IsObject() ? nullptr : &it->second;
}

double numberOf(const tinygltf::Value& object, const char* key, double fallback) {
  if (!object.Has(key) || !object.Get(key).IsNumber()) return fallback;
  const double value = object.Get(key).GetNumberAsDouble();
  return std::isfinite(value) ? value : fallback;
}

std::pair<double, double> pairOf(const tinygltf::Value& object, const char* key, double fallback) {
  if (!object.Has(key)) return {fallback, fallback};
  const tinygltf::Value& value = object.Get(key);
  if (!value.IsArray() || value.ArrayLen() != 2 || !value.Get(0).IsNumber() || !value.Get(1).IsNumber())
    return {fallback, fallback};
  const double first = value.Get(0).GetNumberAsDouble(), second = value.Get(1).GetNumberAsDouble();
  constexpr double kMost = 1e6;  // far from where a float has no fraction of a texel left
  if (std::abs(first) > kMost || std::abs(second) > kMost) return {fallback, fallback};
  return {first, second};
}

// offset + R S uv with u' = c u + s v, v' = c v - s u: counter-clockwise as one sees the image, v downwards. That is
// what the extension's text and the common viewers say; the matrix in its GLSL sample turns the other way.
void applyTransform(const tinygltf::Value& transform, TextureUse& use) {
  const auto [offset_u, offset_v] = pairOf(transform, "offset", 0.0);
  const auto [scale_u, scale_v] = pairOf(transform, "scale", 1.0);
  const double rotation = numberOf(transform, "rotation", 0.0);
  const double c = std::cos(rotation), s = std::sin(rotation);
  use.offset = Vec2(offset_u, offset_v);
  use.linear = glm::mat2(c * scale_u, -s * scale_u, s * scale_v, c * scale_v);
}

Wrap wrapOf(int gl_mode) {
  if (gl_mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Wrap::kClamp;
  return gl_mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? Wrap::kMirror : Wrap::kRepeat;
}

float unit(double value) {
  return value >= 0.0 ? static_cast<float>(std::min(value, 1.0)) : 0.0F;
}

// Metallic-roughness to Blinn-Phong: alpha = roughness^2 as in glTF 2.0 appendix B, exponent 2 / alpha^2 - 2 gives the
// Blinn-Phong lobe the width of that GGX lobe. Reflectance at normal incidence is 0.04 for dielectrics and the base
// colour for metals; (1 - roughness) takes the place of the normalisation that the shading model lacks, else wide
// highlights would be as bright as narrow ones. A metallic-roughness texture is not read: behind one the factors are
// mostly left at 1, which says nothing, so that such a surface is taken as a dielectric of medium roughness.
void setHighlight(const tinygltf::PbrMetallicRoughness& pbr, Material& material) {
  const bool textured = pbr.metallicRoughnessTexture.index >= 0;
  const double roughness = textured ? 0.5 : static_cast<double>(unit(pbr.roughnessFactor));
  const double metallic = textured ? 0.0 : static_cast<double>(unit(pbr.metallicFactor));
  const double alpha = std::max(roughness * roughness, 0.01);
  const Vec4& base = material.base_color;
  const double metal = std::max({base.r, base.g, base.b});
  material.specular = unit((0.04 + (metal - 0.04) * metallic) * (1.0 - roughness));
  material.shininess = static_cast<float>(std::clamp(2.0 / (alpha * alpha) - 2.0, 1.0, 4096.0));
}

}  // namespace

void GltfMaterials::warn(std::string_view text) {
  scene_.warnings.push_back(fmt::format("{}: {}", document_.name(), printable(text)));
}

const tinygltf::Material* GltfMaterials::find(int gltf_material) const {
  const auto& all = document_.model().materials;
  if (gltf_material == -1) return nullptr;
  if (gltf_material < 0 || static_cast<std::size_t>(gltf_material) >= all.size())
    document_.fail(fmt::format("material {} does not exist, there are {}", gltf_material, all.size()));
  return &all[static_cast<std::size_t>(gltf_material)];
}

int GltfMaterials::texcoordSet(int gltf_material) const {
  const tinygltf::Material* material = find(gltf_material);
  if (material == nullptr || material->pbrMetallicRoughness.baseColorTexture.index < 0) return -1;
  const tinygltf::TextureInfo& info = material->pbrMetallicRoughness.baseColorTexture;
  const tinygltf::Value* transform = transformOf(info);
  if (transform != nullptr && transform->Has("texCoord") && transform->Get("texCoord").IsInt())
    return transform->Get("texCoord").GetNumberAsInt();
  return info.texCoord;
}

std::uint32_t GltfMaterials::number(int gltf_material, bool flat) {
  const auto [it, is_new] =
      numbers_.try_emplace({gltf_material, flat}, static_cast<std::uint32_t>(scene_.materials.size()));
  if (!is_new) return it->second;
  const tinygltf::Material* source = find(gltf_material);
  Material material = convert(source == nullptr ? tinygltf::Material() : *source);
  if (flat && material.shading == Shading::kSmooth) material.shading = Shading::kFlat;
  scene_.materials.push_back(std::move(material));
  return it->second;
}

Material GltfMaterials::convert(const tinygltf::Material& source) {
  const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
  Material material;
  material.name = source.name;
  material.base_color = Vec4(1.0F);
  if (pbr.baseColorFactor.size() == 4)
    for (int i = 0; i < 4; ++i) material.base_color[i] = unit(pbr.baseColorFactor[static_cast<std::size_t>(i)]);
  if (pbr.baseColorTexture.index >= 0) material.base_color_texture = convertTexture(pbr.baseColorTexture);
  setHighlight(pbr, material);
  material.double_sided = source.doubleSided;
  if (source.extensions.count("KHR_materials_unlit") > 0) material.shading = Shading::kUnlit;
  if (source.alphaMode == "BLEND" || source.alphaMode == "MASK")
    warn(fmt::format("material '{}' is drawn opaque (alphaMode {})", source.name, source.alphaMode));
  return material;
}

TextureUse GltfMaterials::convertTexture(const tinygltf::TextureInfo& info) {
  TextureUse use;
  const auto& textures = document_.model().textures;
  if (static_cast<std::size_t>(info.index) >= textures.size()) {
    warn(fmt::format("texture {} does not exist, there are {}", info.index, textures.size()));
    return use;
  }
  const tinygltf::Texture& texture = textures[static_cast<std::size_t>(info.index)];
  use.texture = imageNumber(texture.source);
  const auto& samplers = document_.model().samplers;
  if (texture.sampler >= 0 && static_cast<std::size_t>(texture.sampler) < samplers.size()) {
    const tinygltf::Sampler& sampler = samplers[static_cast<std::size_t>(texture.sampler)];
    use.wrap_u = wrapOf(sampler.wrapS);
    use.wrap_v = wrapOf(sampler.wrapT);
    if (sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST) use.filter = Filter::kNearest;
  }
  if (const tinygltf::Value* transform = transformOf(info)) applyTransform(*transform, use);
  return use;
}

std::int32_t GltfMaterials::imageNumber(int image) {
  const auto [it, is_new] = image_numbers_.try_emplace(image, -1);
  if (!is_new) return it->second;
  try {
    const std::string name = fmt::format("image {}", image);
    Image8 pixels = decodeImage(document_.imageFile(image), name);
    it->second = static_cast<std::int32_t>(scene_.textures.size());
    scene_.textures.push_back({name, std::move(pixels)});
  } catch (const Error& e) {
    warn(fmt::format("texture not used: {}", e.what()));
  }
  return it->second;
}

}  // namespace sheaf::scenes
