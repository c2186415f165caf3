// Blocks of buildings: few meshes, many instances.
#include "scenes/builtin_scenes.h"
#include "scenes/noise.h"
#include "scenes/paint.h"
#include "scenes/shapes.h"

namespace sheaf::scenes {
namespace {

constexpr double kBlock = 60.0;  // metres from street to street
constexpr double kStreet = 14.0;
constexpr int kLots = 3;  // buildings along each side of a block
constexpr double kFloorHeight = 3.5;

/// A unit building: footprint [-0.5, 0.5]^2, height 1; instances stretch it.
using Footprint = std::vector<std::array<double, 2>>;

Footprint square(double half) {
  return {{-half, half}, {half, half}, {half, -half}, {-half, -half}};
}

mesh::Mesh stack(std::initializer_list<std::pair<Footprint, std::array<double, 2>>> storeys) {
  mesh::Mesh m;
  for (const auto& [footprint, range] : storeys) append(m, prismMesh(footprint, range[0], range[1]));
  return m;
}

mesh::Mesh roundTower() {
  const std::array<ProfilePiece, 3> profile = {ProfilePiece{{{0.0, 1.0}, {0.2, 1.0}, {0.42, 0.98}, {0.45, 0.92}}},
                                               straightPiece(0.45, 0.92, 0.45, 0.0),
                                               straightPiece(0.45, 0.0, 0.0, 0.0)};
  return revolve(profile, 32, 4);
}

/// A house with a pitched roof.
mesh::Mesh house() {
  mesh::Mesh m = prismMesh(square(0.45), 0.0, 0.65);
  // The roof is a prism of its own, lying on its side: its footprint is the gable.
  const std::array<std::array<double, 2>, 3> gable = {{{-0.5, 0.0}, {0.5, 0.0}, {0.0, -0.35}}};
  mesh::Mesh roof = prismMesh(gable, -0.5, 0.5);
  for (auto* vectors : {&roof.positions, &roof.normals})
    for (Vec3& p : *vectors) p = Vec3(p.x, -p.z, p.y);
  for (Vec3& p : roof.positions) p.y += 0.65F;
  append(m, roof);
  return m;
}

mesh::Mesh tree() {
  mesh::Mesh m =
      revolve(std::array<ProfilePiece, 2>{ProfilePiece{{{0.0, 1.0}, {0.34, 1.0}, {0.50, 0.72}, {0.46, 0.52}}},
                                          ProfilePiece{{{0.46, 0.52}, {0.40, 0.30}, {0.12, 0.34}, {0.05, 0.30}}}},
              12, 3);
  append(m,
         revolve(std::array<ProfilePiece, 2>{straightPiece(0.05, 0.30, 0.06, 0.0), straightPiece(0.06, 0.0, 0.0, 0.0)},
                 12, 1));
  return m;
}

/// Eight storeys of eight windows.
Image8 paintFacade(const DVec3& wall, const DVec3& glass, double window_width, double window_height,
                   std::uint32_t seed) {
  return paintImage(256, 256, [&](double u, double v) {
    const int column = static_cast<int>(8.0 * u);
    const int row = static_cast<int>(8.0 * v);
    const double x = std::abs(8.0 * u - column - 0.5);
    const double y = std::abs(8.0 * v - row - 0.5);
    const double grain = 0.92 + 0.16 * valueNoise(40.0 * u, 40.0 * v, 0.0, seed);
    if (x > 0.5 * window_width || y > 0.5 * window_height) return wall * grain;
    const double tint = hashFraction(column, row, 0, seed);
    return tint > 0.93 ? DVec3(0.75, 0.62, 0.36) : glass * (0.6 + 0.8 * tint);
  });
}

enum class Kind : std::uint32_t { kTower, kStepped, kRound, kSlab, kHouse, kTree, kPavement, kCount };

class City {
 public:
  City(int blocks, std::uint32_t seed) : blocks_(blocks), seed_(seed) {
    addMeshes();
    addMaterials();
    addGround();
    for (int z = 0; z < blocks; ++z)
      for (int x = 0; x < blocks; ++x) addBlock(x, z);
  }

  Scene take() { return std::move(scene_); }

 private:
  static constexpr std::uint32_t kFacades = 5;
  static constexpr std::uint32_t kRoofs = 3;
  static constexpr std::uint32_t kFirstRoof = kFacades;
  static constexpr std::uint32_t kLeaves = kFirstRoof + kRoofs;
  static constexpr std::uint32_t kPavementStone = kLeaves + 1;
  static constexpr std::uint32_t kAsphalt = kLeaves + 2;

  double chance(int x, int z, int what) const { return hashFraction(x, z, what, seed_); }

  void addMeshes() {
    scene_.meshes.resize(static_cast<std::size_t>(Kind::kCount));
    mesh::Mesh* m = scene_.meshes.data();
    m[static_cast<std::size_t>(Kind::kTower)] = stack({{square(0.46), {0.0, 0.97}}, {square(0.16), {0.97, 1.0}}});
    m[static_cast<std::size_t>(Kind::kStepped)] = stack({{square(0.48), {0.0, 0.45}},
                                                         {square(0.38), {0.45, 0.72}},
                                                         {square(0.27), {0.72, 0.9}},
                                                         {square(0.05), {0.9, 1.0}}});
    m[static_cast<std::size_t>(Kind::kRound)] = roundTower();
    m[static_cast<std::size_t>(Kind::kSlab)] =
        stack({{{{-0.48, 0.2}, {0.48, 0.2}, {0.48, -0.3}, {-0.48, -0.3}}, {0.0, 1.0}},
               {{{-0.48, 0.48}, {-0.1, 0.48}, {-0.1, 0.2}, {-0.48, 0.2}}, {0.0, 0.4}}});
    m[static_cast<std::size_t>(Kind::kHouse)] = house();
    m[static_cast<std::size_t>(Kind::kTree)] = tree();
    m[static_cast<std::size_t>(Kind::kPavement)] = prismMesh(square(0.5), 0.0, 1.0);
  }

  void addMaterials() {
    const std::array<std::pair<DVec3, DVec3>, kFacades> facades = {
        {{DVec3(0.55, 0.50, 0.42), DVec3(0.07, 0.10, 0.14)},
         {DVec3(0.42, 0.20, 0.13), DVec3(0.10, 0.11, 0.12)},
         {DVec3(0.20, 0.26, 0.32), DVec3(0.10, 0.20, 0.30)},
         {DVec3(0.66, 0.65, 0.62), DVec3(0.05, 0.08, 0.12)},
         {DVec3(0.36, 0.33, 0.30), DVec3(0.16, 0.24, 0.28)}}};
    for (std::uint32_t i = 0; i < kFacades; ++i) {
      const double wide = i == 2 ? 0.9 : 0.45 + 0.1 * (i % 3);
      Material& m = addMaterial("facade " + std::to_string(i), Vec3(1.0F));
      m.base_color_texture.texture = static_cast<std::int32_t>(scene_.textures.size());
      m.specular = i == 2 ? 0.15F : 0.04F;
      scene_.textures.push_back({m.name, paintFacade(facades[i].first, facades[i].second, wide, 0.62, 300 + i)});
    }
    addMaterial("roof tiles", Vec3(0.38F, 0.12F, 0.07F));
    addMaterial("roof slate", Vec3(0.12F, 0.13F, 0.15F));
    addMaterial("plaster", Vec3(0.68F, 0.58F, 0.42F));
    addMaterial("leaves", Vec3(0.08F, 0.20F, 0.05F));
    addMaterial("pavement", Vec3(0.42F, 0.41F, 0.39F));
    addMaterial("asphalt", Vec3(0.10F, 0.10F, 0.11F));
  }

  Material& addMaterial(const std::string& name, const Vec3& color) {
    Material m;
    m.name = name;
    m.base_color = Vec4(color, 1.0F);
    m.specular = 0.03F;
    return scene_.materials.emplace_back(std::move(m));
  }

  /// quarter_turns about +Y
  void add(Kind kind, std::uint32_t material, const DVec3& foot, const DVec3& size, int quarter_turns) {
    static constexpr std::array<double, 4> kCos = {1.0, 0.0, -1.0, 0.0};
    const double c = kCos[static_cast<std::size_t>(quarter_turns & 3)];
    const double s = kCos[static_cast<std::size_t>((quarter_turns + 3) & 3)];
    scene_.instances.push_back({static_cast<std::uint32_t>(kind), material,
                                DMat4(DVec4(c * size.x, 0.0, -s * size.x, 0.0), DVec4(0.0, size.y, 0.0, 0.0),
                                      DVec4(s * size.z, 0.0, c * size.z, 0.0), DVec4(foot, 1.0))});
  }

  void addGround() {
    const double side = blocks_ * kBlock + kStreet;
    add(Kind::kPavement, kAsphalt, DVec3(0.0, -1.0, 0.0), DVec3(side, 1.0, side), 0);
  }

  void addBlock(int block_x, int block_z) {
    const DVec3 center((block_x - 0.5 * (blocks_ - 1)) * kBlock, 0.0, (block_z - 0.5 * (blocks_ - 1)) * kBlock);
    const double side = kBlock - kStreet;
    add(Kind::kPavement, kPavementStone, center, DVec3(side, 0.25, side), 0);
    if (chance(block_x, block_z, 0) < 0.10) {
      addPark(block_x, block_z, center, side);
      return;
    }
    for (int j = 0; j < kLots; ++j)
      for (int i = 0; i < kLots; ++i) {
        const double lot = (side - 2.0) / kLots;
        const DVec3 foot = center + DVec3((i - 0.5 * (kLots - 1)) * lot, 0.25, (j - 0.5 * (kLots - 1)) * lot);
        addBuilding(block_x * kLots + i, block_z * kLots + j, foot, lot - 1.5);
      }
  }

  void addPark(int block_x, int block_z, const DVec3& center, double side) {
    for (int i = 0; i < 40; ++i) {
      const double x = chance(block_x, block_z, 100 + 3 * i) - 0.5;
      const double z = chance(block_x, block_z, 101 + 3 * i) - 0.5;
      const double size = 5.0 + 5.0 * chance(block_x, block_z, 102 + 3 * i);
      add(Kind::kTree, kLeaves, center + DVec3(0.9 * side * x, 0.25, 0.9 * side * z),
          DVec3(0.7 * size, size, 0.7 * size), i);
    }
  }

  void addBuilding(int x, int z, const DVec3& foot, double side) {
    // Tall in the middle, low at the edge, with some chance everywhere.
    const double extent = 0.5 * blocks_ * kBlock;
    const double away = std::sqrt(foot.x * foot.x + foot.z * foot.z) / extent;
    const double centrality = std::clamp(1.15 - away, 0.0, 1.0);
    const double luck = chance(x, z, 1);
    const double storeys = std::floor(3.0 + 8.0 * luck + 42.0 * centrality * centrality * luck * luck);
    const int turns = static_cast<int>(4.0 * chance(x, z, 2));
    const auto facade = static_cast<std::uint32_t>(kFacades * chance(x, z, 3));
    if (storeys < 6.0) {
      const auto roof = kFirstRoof + static_cast<std::uint32_t>(kRoofs * chance(x, z, 4));
      add(Kind::kHouse, roof, foot, DVec3(side, (storeys + 1.0) * kFloorHeight, side), turns);
      return;
    }
    static constexpr std::array<Kind, 5> kKinds = {Kind::kTower, Kind::kStepped, Kind::kSlab, Kind::kTower,
                                                   Kind::kRound};
    add(kKinds[static_cast<std::size_t>(5.0 * chance(x, z, 5))], facade, foot,
        DVec3(side, storeys * kFloorHeight, side), turns);
  }

  int blocks_;
  std::uint32_t seed_;
  Scene scene_;
};

}  // namespace

Scene buildCity(const BuiltinArguments& arguments) {
  const int blocks = arguments.whole("blocks");
  Scene scene = City(blocks, static_cast<std::uint32_t>(arguments.whole("seed"))).take();
  scene.lights.push_back({Vec3(glm::normalize(DVec3(-0.75, 0.8, 0.35))), Vec3(0.86F, 0.78F, 0.66F)});
  scene.ambient.sky = Vec3(0.26F, 0.31F, 0.38F);
  scene.ambient.ground = Vec3(0.11F, 0.10F, 0.09F);
  scene.background = Vec3(0.52F, 0.63F, 0.76F);
  const double extent = blocks * kBlock;
  Camera camera;
  camera.name = "from the hill";
  camera.eye = DVec3(0.42 * extent, 0.30 * extent + 40.0, 0.72 * extent + 40.0);
  camera.target = DVec3(0.0, 20.0, 0.05 * extent);
  camera.vertical_fov_rad = radians(42.0);
  scene.cameras.push_back(camera);
  return scene;
}

}  // namespace sheaf::scenes
