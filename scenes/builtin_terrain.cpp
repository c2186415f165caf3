// Fractal hills on a grid.
#include "scenes/builtin_scenes.h"
#include "scenes/noise.h"

namespace sheaf::scenes {
namespace {

constexpr double kSide = 10.0;        // metres along x and z
constexpr double kFeatures = 3.0;     // cells of the coarsest noise along a side
constexpr double kHighest = 2.3;      // metres, at relief 1
constexpr double kWaterLevel = 0.30;  // fraction of the height range that is under water
constexpr int kOctaves = 9;           // the finest cell is kSide / (kFeatures * 2^8): 1.3 cm

/// Height of the ground before the water fills it, as a fraction. x and z in cells of the coarsest noise.
double groundLevel(double x, double z, std::uint32_t seed) {
  const double base = fractalNoise(x, z, 0.0, kOctaves, 0.45, seed);
  // Folding the noise about its middle makes ridges; they rise with the land so that valleys stay gentle.
  const double folded = 1.0 - std::abs(2.0 * fractalNoise(x + 31.7, z - 17.3, 0.0, kOctaves, 0.42, seed + 101) - 1.0);
  const double land = std::clamp((base - 0.25) / 0.5, 0.0, 1.0);
  return land * (0.45 + 0.55 * folded * folded);
}

Vec3 mix(const Vec3& a, const Vec3& b, double t) {
  return a + static_cast<float>(std::clamp(t, 0.0, 1.0)) * (b - a);
}

/// level: fraction of the height range above water; steepness: 1 - normal.y; grain in [0, 1) breaks up the borders.
Vec3 groundColor(double level, double steepness, double grain) {
  const Vec3 sand(0.52F, 0.44F, 0.28F);
  const Vec3 meadow(0.13F, 0.24F, 0.05F);
  const Vec3 forest(0.05F, 0.12F, 0.04F);
  const Vec3 rock(0.22F, 0.19F, 0.16F);
  const Vec3 snow(0.86F, 0.89F, 0.93F);
  const double wobble = 0.12 * (grain - 0.5);
  Vec3 color = mix(sand, meadow, (level - 0.02 + 0.3 * wobble) / 0.03);
  color = mix(color, forest, (level - 0.14 + wobble) / 0.16);
  color = mix(color, rock, (level - 0.42 + wobble) / 0.12);
  color = mix(color, rock, (steepness - 0.26 + wobble) / 0.12);
  color = mix(color, snow, std::min((level - 0.58 + wobble) / 0.06, (0.50 - steepness) / 0.12));
  return color * static_cast<float>(0.85 + 0.3 * grain);
}

// Levels of the ground over a grid, 0 at the water and 1 at the highest peak, with one more sample on every side, so
// that normals at the rim see both of their neighbours.
class Ground {
 public:
  Ground(int n, double height_range, std::uint32_t seed)
      : padded_(static_cast<std::size_t>(n) + 2), height_range_(height_range), levels_(padded_ * padded_) {
    for (std::size_t j = 0; j < padded_; ++j)
      for (std::size_t i = 0; i < padded_; ++i) {
        const double x = kFeatures * (static_cast<double>(i) - 1.0) / (n - 1);
        const double z = kFeatures * (static_cast<double>(j) - 1.0) / (n - 1);
        levels_[j * padded_ + i] = (groundLevel(x, z, seed) - kWaterLevel) / (1.0 - kWaterLevel);
      }
  }

  // Of the padded grid: [1, n] is the terrain.
  double level(std::size_t i, std::size_t j) const { return levels_[j * padded_ + i]; }
  double height(std::size_t i, std::size_t j) const { return height_range_ * std::max(0.0, level(i, j)); }

 private:
  std::size_t padded_;
  double height_range_;
  std::vector<double> levels_;
};

void addVertices(const Ground& ground, int n, std::uint32_t seed, mesh::Mesh& m) {
  const auto side = static_cast<std::size_t>(n);
  const double step = kSide / (n - 1);
  for (auto* attribute : {&m.positions, &m.normals}) attribute->reserve(side * side);
  m.texcoords.reserve(side * side);
  m.colors.reserve(side * side);
  for (std::size_t j = 1; j <= side; ++j)
    for (std::size_t i = 1; i <= side; ++i) {
      const double u = static_cast<double>(i - 1) / (n - 1);
      const double v = static_cast<double>(j - 1) / (n - 1);
      const DVec3 normal = glm::normalize(DVec3(ground.height(i - 1, j) - ground.height(i + 1, j), 2.0 * step,
                                                ground.height(i, j - 1) - ground.height(i, j + 1)));
      const double level = ground.level(i, j);
      const double grain = fractalNoise(40.0 * u, 40.0 * v, 0.0, 4, 0.6, seed + 211);
      const Vec3 color = level > 0.0 ? groundColor(level, 1.0 - normal.y, grain)
                                     : mix(Vec3(0.10F, 0.30F, 0.34F), Vec3(0.02F, 0.07F, 0.16F), level / -0.18);
      m.positions.emplace_back(kSide * (u - 0.5), ground.height(i, j), kSide * (v - 0.5));
      m.normals.emplace_back(normal);
      m.texcoords.emplace_back(u, v);
      m.colors.emplace_back(color, 1.0F);
    }
}

void addTriangles(int n, mesh::Mesh& m) {
  const auto side = static_cast<std::size_t>(n);
  m.triangles.reserve(2 * (side - 1) * (side - 1));
  for (std::size_t j = 0; j + 1 < side; ++j)
    for (std::size_t i = 0; i + 1 < side; ++i) {
      const auto a = static_cast<std::uint32_t>(j * side + i);
      const auto b = static_cast<std::uint32_t>(a + side);
      m.triangles.push_back({a, b, b + 1});
      m.triangles.push_back({a, b + 1, a + 1});
    }
}

Material groundMaterial() {
  Material material;
  material.name = "ground";
  material.base_color = Vec4(1.0F);
  material.specular = 0.02F;
  material.shininess = 12.0F;
  return material;
}

// A low sun shows the relief.
void addLight(Scene& scene) {
  scene.lights.push_back({Vec3(glm::normalize(DVec3(-0.8, 0.62, 0.25))), Vec3(0.92F, 0.83F, 0.70F)});
  scene.ambient.sky = Vec3(0.22F, 0.27F, 0.34F);
  scene.ambient.ground = Vec3(0.08F, 0.08F, 0.07F);
  scene.background = Vec3(0.50F, 0.62F, 0.76F);
}

Camera cameraFromTheSouth() {
  Camera camera;
  camera.name = "from the south";
  camera.eye = DVec3(1.2, 5.6, 10.4);
  camera.target = DVec3(0.0, 0.0, 0.35);
  camera.vertical_fov_rad = radians(40.0);
  return camera;
}

}  // namespace

Scene buildTerrain(const BuiltinArguments& arguments) {
  const int n = arguments.whole("n");
  const auto seed = static_cast<std::uint32_t>(arguments.whole("seed"));
  const Ground ground(n, kHighest * arguments.number("relief"), seed);
  Scene scene;
  addVertices(ground, n, seed, scene.meshes.emplace_back());
  addTriangles(n, scene.meshes.back());
  scene.materials.push_back(groundMaterial());
  scene.instances.emplace_back();
  addLight(scene);
  scene.cameras.push_back(cameraFromTheSouth());
  return scene;
}

}  // namespace sheaf::scenes
