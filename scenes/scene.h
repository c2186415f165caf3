// scenes: plain data that describes what is to be drawn, and how files and built-in generators become such data.
//   In     a file (glTF/GLB, OBJ+MTL, PLY, STL, OFF; .gz of the text formats) or `builtin:NAME?key=value&...`
//   Out    Scene: right-handed, +Y up, metres; the camera looks down -Z; colours linear unless a name says sRGB
//   Keeps  every index in a Scene is in range, every position of a triangle finite: importers see to it
//   Knows  no pixels and no groups
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/math.h"
#include "mesh/mesh.h"

namespace sheaf::scenes {

enum class Wrap : std::uint8_t { kRepeat, kClamp, kMirror };
enum class Filter : std::uint8_t { kTrilinear, kNearest };

/// How a material reads its texture: uv_texture = offset + linear * uv_mesh (KHR_texture_transform), then wrapped.
struct TextureUse {
  std::int32_t texture = -1;  ///< index into Scene::textures, -1 = none
  Wrap wrap_u = Wrap::kRepeat;
  Wrap wrap_v = Wrap::kRepeat;
  Filter filter = Filter::kTrilinear;
  glm::mat2 linear{1.0F};
  Vec2 offset{0.0F};
};

/// Solid textures, evaluated at object-space positions times `frequency`.
enum class Solid : std::uint8_t { kNone, kMarble, kWood, kChecker };

enum class Shading : std::uint8_t {
  kSmooth,  ///< interpolated vertex normals
  kFlat,    ///< the triangle's own normal
  kUnlit,   ///< base colour as it is
};

struct Material {
  std::string name;
  Vec4 base_color{0.8F, 0.8F, 0.8F, 1.0F};  ///< linear; multiplied with texture and vertex colour
  TextureUse base_color_texture;
  Solid solid = Solid::kNone;          ///< multiplied with base_color; mixes solid_colors
  std::array<Vec3, 2> solid_colors{};  ///< linear
  float solid_frequency = 1.0F;        ///< per object-space unit
  float specular = 0.04F;              ///< Blinn-Phong strength at normal incidence, [0, 1]
  float shininess = 32.0F;             ///< Blinn-Phong exponent, [1, 4096]
  Shading shading = Shading::kSmooth;
  bool double_sided = false;  ///< else back faces are culled
};

/// sRGB-coded colour, straight linear alpha; top row first.
struct Texture {
  std::string name;
  Image8 pixels;
};

/// One drawn copy of a mesh.
struct Instance {
  std::uint32_t mesh = 0;
  std::uint32_t material = 0;
  DMat4 world_from_object{1.0};  ///< affine; a negative determinant turns the winding round
};

/// Parallel light.
struct Light {
  Vec3 direction_to_light_world{0.0F, 1.0F, 0.0F};  ///< unit
  Vec3 radiance{1.0F};                              ///< linear; a white Lambert surface facing it returns this value
};

/// Hemisphere term: sky from +Y, ground from -Y, blended by the normal.
struct Ambient {
  Vec3 sky{0.0F};
  Vec3 ground{0.0F};
};

/// Perspective when `orthographic_height` is 0, else parallel. Near and far may be left to fitClipPlanes().
struct Camera {
  std::string name;
  DVec3 eye{0.0, 0.0, 1.0};
  DVec3 target{0.0};
  DVec3 up{0.0, 1.0, 0.0};
  double vertical_fov_rad = 0.6981317007977318;  ///< 40 degrees
  double orthographic_height = 0.0;              ///< world units from bottom to top of the picture; 0 = perspective
  double near = 0.0;                             ///< distance, > 0 when set; 0 = fit to the scene
  double far = 0.0;                              ///< distance, > near when set; 0 = fit to the scene
};

struct Scene {
  std::string name;
  std::vector<mesh::Mesh> meshes;
  std::vector<Material> materials;  ///< at least one
  std::vector<Texture> textures;
  std::vector<Instance> instances;
  std::vector<Camera> cameras;  ///< may be empty: fitCamera() makes one
  std::vector<Light> lights;    ///< may be empty: addDefaultLights() makes some
  Ambient ambient;
  std::optional<Vec3> background;     ///< linear; what the scene would like behind it
  std::vector<std::string> warnings;  ///< one line each, naming file and place

  std::size_t triangleCount() const;  ///< over all instances
  std::size_t vertexCount() const;    ///< over all instances
};

/// World-space box over all instances; empty for a scene without triangles.
Box3 boundsOf(const Scene& scene);

/// Reads a file or builds `builtin:NAME?...`. Throws Error.
struct ImportOptions {
  double crease_angle_rad = 1.0471975511965976;  ///< 60 degrees: sharper edges stay sharp where normals are made
  bool z_up = false;                             ///< turn a +Z-up file to +Y up
  /// False leaves a mesh as the file has it: no normals are made, so no vertex is split at a crease, and a PLY or OFF
  /// file may hold points alone.
  bool for_drawing = true;
};
Scene loadScene(const std::string& input, const ImportOptions& options = {});

}  // namespace sheaf::scenes
