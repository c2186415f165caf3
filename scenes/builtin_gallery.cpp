// The picture that shows what sheaf draws: solids on a round dais, with shadows painted into the floors.
#include "scenes/builtin_scenes.h"
#include "scenes/floor_light.h"
#include "scenes/noise.h"
#include "scenes/paint.h"
#include "scenes/shapes.h"
#include "scenes/teapot.h"

namespace sheaf::scenes {
namespace {

constexpr double kDaisRadius = 5.2;
constexpr double kFloorSide = 2.0 * kDaisRadius;
constexpr double kPlinthHeight = 0.42;
constexpr double kColumnHeight = 1.75;

const DVec3 kKeyDirection = glm::normalize(DVec3(-0.62, 1.0, 0.72));
constexpr double kKeyRadiance = 0.80;
constexpr double kFillRadiance = 0.12;
constexpr double kSkyRadiance = 0.26;

DMat4 placed(double x, double y, double z, double scale = 1.0, double turn_rad = 0.0) {
  const double c = scale * std::cos(turn_rad);
  const double s = scale * std::sin(turn_rad);
  return {DVec4(c, 0.0, -s, 0.0), DVec4(0.0, scale, 0.0, 0.0), DVec4(s, 0.0, c, 0.0), DVec4(x, y, z, 1.0)};
}

/// Collects meshes, materials and instances, and knows what casts shadows.
class Arrangement {
 public:
  explicit Arrangement(int detail) : detail_(detail) {}

  std::uint32_t addMaterial(Material material) {
    scene_.materials.push_back(std::move(material));
    return static_cast<std::uint32_t>(scene_.materials.size() - 1);
  }

  /// shape(detail); shadows are those of shape(1), so that more detail changes nothing but the outlines.
  std::uint32_t addMesh(const std::function<mesh::Mesh(int detail)>& shape) {
    scene_.meshes.push_back(shape(detail_));
    casters_.push_back(shape(1));
    return static_cast<std::uint32_t>(scene_.meshes.size() - 1);
  }

  void add(std::uint32_t mesh, std::uint32_t material, const DMat4& world_from_object) {
    scene_.instances.push_back({mesh, material, world_from_object});
  }

  std::int32_t addTexture(const std::string& name, Image8 pixels) {
    scene_.textures.push_back({name, std::move(pixels)});
    return static_cast<std::int32_t>(scene_.textures.size() - 1);
  }

  /// Shadows of all instances added so far.
  FloorLight lightOn(const FloorArea& area) const {
    std::vector<Occluder> occluders;
    for (const Instance& i : scene_.instances) occluders.push_back({&casters_[i.mesh], i.world_from_object});
    return computeFloorLight(area, occluders, kKeyDirection);
  }

  Scene& scene() { return scene_; }

 private:
  int detail_;
  Scene scene_;
  std::vector<mesh::Mesh> casters_;
};

Material plain(const std::string& name, const Vec3& color, float specular, float shininess) {
  Material m;
  m.name = name;
  m.base_color = Vec4(color, 1.0F);
  m.specular = specular;
  m.shininess = shininess;
  return m;
}

Material solid(const std::string& name, Solid kind, const Vec3& first, const Vec3& second, float frequency) {
  Material m = plain(name, Vec3(1.0F), 0.08F, 60.0F);
  m.solid = kind;
  m.solid_colors = {first, second};
  m.solid_frequency = frequency;
  return m;
}

Material whiteMarble() {
  return solid("white marble", Solid::kMarble, Vec3(0.82F, 0.80F, 0.76F), Vec3(0.17F, 0.18F, 0.21F), 1.0F);
}

// Shapes ----------------------------------------------------------------------------------------------------------

/// A column's drum with twenty flutes, between a base and a capital that are turned.
mesh::Mesh columnShaft(int detail) {
  constexpr int kFlutes = 20;
  constexpr double kBottom = 0.22;
  constexpr double kTop = kColumnHeight - 0.20;
  return gridSurface({kFlutes * 6 * detail, 8 * detail, true, false}, [](double u, double v) {
    const double angle = 2.0 * kPi * u;
    const double y = kTop + v * (kBottom - kTop);
    const double across = kFlutes * u - std::floor(kFlutes * u);
    const double dent = 0.045 * std::sin(kPi * across);  // a groove with a sharp ridge on either side
    const double taper = 0.58 + 0.06 * v;
    const double radius = taper - dent;
    const double slope = across == 0.0 ? 0.0 : -0.045 * kFlutes / 2.0 * std::cos(kPi * across);
    const DVec3 outwards(std::sin(angle), 0.0, std::cos(angle));
    const DVec3 sideways(std::cos(angle), 0.0, -std::sin(angle));
    return SurfacePoint{radius * outwards + DVec3(0.0, y, 0.0), outwards - (slope / radius) * sideways};
  });
}

mesh::Mesh columnEnds(int detail) {
  const double top = kColumnHeight;
  const std::array<ProfilePiece, 4> capital = {
      straightPiece(0.0, top, 0.80, top), straightPiece(0.80, top, 0.80, top - 0.10),
      ProfilePiece{{{0.80, top - 0.10}, {0.76, top - 0.16}, {0.66, top - 0.17}, {0.58, top - 0.20}}},
      straightPiece(0.58, top - 0.20, 0.0, top - 0.20)};
  const std::array<ProfilePiece, 4> base = {
      straightPiece(0.0, 0.22, 0.66, 0.22), ProfilePiece{{{0.66, 0.22}, {0.80, 0.22}, {0.80, 0.10}, {0.74, 0.10}}},
      straightPiece(0.74, 0.10, 0.86, 0.10), straightPiece(0.86, 0.10, 0.86, 0.0)};
  mesh::Mesh both = revolve(capital, 48 * detail, 6 * detail);
  append(both, revolve(base, 48 * detail, 6 * detail));
  return both;
}

mesh::Mesh vase(int detail) {
  const std::array<ProfilePiece, 7> profile = {
      ProfilePiece{{{0.0, 1.50}, {0.10, 1.50}, {0.14, 1.60}, {0.17, 1.90}}},  // inside of the neck
      ProfilePiece{{{0.17, 1.90}, {0.18, 2.00}, {0.22, 2.10}, {0.34, 2.14}}},
      ProfilePiece{{{0.34, 2.14}, {0.38, 2.15}, {0.38, 2.11}, {0.34, 2.10}}},  // lip
      ProfilePiece{{{0.34, 2.10}, {0.26, 2.06}, {0.22, 1.94}, {0.23, 1.80}}},  // neck
      ProfilePiece{{{0.23, 1.80}, {0.25, 1.52}, {0.66, 1.42}, {0.66, 1.02}}},  // shoulder
      ProfilePiece{{{0.66, 1.02}, {0.66, 0.62}, {0.30, 0.34}, {0.30, 0.10}}},  // belly
      ProfilePiece{{{0.30, 0.10}, {0.30, 0.06}, {0.40, 0.04}, {0.40, 0.0}}},   // foot
  };
  return revolve(profile, 72 * detail, 10 * detail);
}

mesh::Mesh pawn(int detail) {
  const std::array<ProfilePiece, 7> profile = {
      ProfilePiece{{{0.0, 1.30}, {0.132, 1.30}, {0.24, 1.192}, {0.24, 1.06}}},  // head
      ProfilePiece{{{0.24, 1.06}, {0.24, 0.95}, {0.19, 0.88}, {0.14, 0.84}}},
      ProfilePiece{{{0.14, 0.84}, {0.34, 0.84}, {0.34, 0.76}, {0.15, 0.75}}},  // collar
      ProfilePiece{{{0.15, 0.75}, {0.16, 0.50}, {0.22, 0.36}, {0.32, 0.28}}},  // body
      ProfilePiece{{{0.32, 0.28}, {0.40, 0.27}, {0.40, 0.19}, {0.34, 0.18}}},  // ring
      ProfilePiece{{{0.34, 0.18}, {0.46, 0.16}, {0.48, 0.08}, {0.48, 0.05}}},  // foot
      straightPiece(0.48, 0.05, 0.48, 0.0)};
  return revolve(profile, 56 * detail, 8 * detail);
}

mesh::Mesh globeStand(int detail) {
  const std::array<ProfilePiece, 5> profile = {ProfilePiece{{{0.0, 0.40}, {0.10, 0.40}, {0.20, 0.42}, {0.24, 0.46}}},
                                               ProfilePiece{{{0.24, 0.46}, {0.30, 0.46}, {0.28, 0.40}, {0.16, 0.34}}},
                                               ProfilePiece{{{0.16, 0.34}, {0.08, 0.28}, {0.12, 0.16}, {0.30, 0.10}}},
                                               ProfilePiece{{{0.30, 0.10}, {0.46, 0.08}, {0.52, 0.08}, {0.52, 0.04}}},
                                               straightPiece(0.52, 0.04, 0.52, 0.0)};
  return revolve(profile, 56 * detail, 8 * detail);
}

/// A cut stone: table, crown and pavilion, all facets flat.
mesh::Mesh gem(int /*detail*/) {
  constexpr int kSides = 8;
  const auto ring = [](double radius, double y, double offset) {
    std::vector<DVec3> points;
    for (int i = 0; i < kSides; ++i) {
      const double angle = 2.0 * kPi * (i + offset) / kSides;
      points.emplace_back(radius * std::sin(angle), y, radius * std::cos(angle));
    }
    return points;
  };
  const std::vector<DVec3> table = ring(0.30, 0.78, 0.5);
  const std::vector<DVec3> girdle = ring(0.52, 0.56, 0.0);
  const DVec3 top(0.0, 0.78, 0.0);
  const DVec3 tip(0.0, 0.0, 0.0);
  mesh::Mesh m;
  const auto facet = [&](const DVec3& a, const DVec3& b, const DVec3& c) {
    const auto first = static_cast<std::uint32_t>(m.vertexCount());
    const Vec3 normal(glm::normalize(glm::cross(b - a, c - a)));
    for (const DVec3& p : {a, b, c}) {
      m.positions.emplace_back(p);
      m.normals.push_back(normal);
      m.texcoords.emplace_back(p.x, p.z);
    }
    m.triangles.push_back({first, first + 1, first + 2});
  };
  for (std::size_t i = 0; i < kSides; ++i) {
    const std::size_t next = (i + 1) % kSides;
    facet(top, table[i], table[next]);
    facet(table[i], girdle[i], girdle[next]);
    facet(table[i], girdle[next], table[next]);
    facet(girdle[i], tip, girdle[next]);
  }
  return m;
}

/// The slab under the floor disc, without its top.
mesh::Mesh daisRim(int detail) {
  const double r = kDaisRadius;
  const std::array<ProfilePiece, 3> profile = {
      ProfilePiece{{{r, 0.0}, {r + 0.05, 0.0}, {r + 0.08, -0.03}, {r + 0.08, -0.08}}},
      straightPiece(r + 0.08, -0.08, r + 0.08, -0.34), straightPiece(r + 0.08, -0.34, 0.0, -0.34)};
  return revolve(profile, 128 * detail, 3 * detail);
}

/// The step below the slab.
mesh::Mesh daisStep(int detail) {
  const double r = kDaisRadius + 0.55;
  const std::array<ProfilePiece, 4> profile = {
      straightPiece(0.0, -0.34, r, -0.34),
      ProfilePiece{{{r, -0.34}, {r + 0.05, -0.34}, {r + 0.08, -0.37}, {r + 0.08, -0.42}}},
      straightPiece(r + 0.08, -0.42, r + 0.08, -0.68), straightPiece(r + 0.08, -0.68, 0.0, -0.68)};
  return revolve(profile, 128 * detail, 3 * detail);
}

/// A disc of the plane y = 0 whose texture coordinates are those of the square about it.
mesh::Mesh floorDisc(int detail) {
  mesh::Mesh m =
      revolve(std::array<ProfilePiece, 1>{straightPiece(0.0, 0.0, kDaisRadius, 0.0)}, 128 * detail, 16 * detail);
  for (std::size_t i = 0; i < m.vertexCount(); ++i) {
    const Vec3& p = m.positions[i];
    m.texcoords[i] = Vec2(static_cast<double>(p.x) / kFloorSide + 0.5, static_cast<double>(p.z) / kFloorSide + 0.5);
  }
  return m;
}

// Paintings -------------------------------------------------------------------------------------------------------

/// Seas, lands, ice and a grid of meridians, as a map with longitude to the right and colatitude downwards.
Image8 paintGlobe() {
  return paintImage(1024, 512, [](double u, double v) {
    const double longitude = 2.0 * kPi * u;
    const double radius = std::sin(kPi * v);
    const DVec3 p(radius * std::sin(longitude), std::cos(kPi * v), radius * std::cos(longitude));
    const DVec3 q = 1.25 * p + DVec3(11.3, 4.1, 7.9);
    const double land = fractalNoise(q.x, q.y, q.z, 7, 0.52, 5) - 0.50;
    const double rough = fractalNoise(6.0 * q.x, 6.0 * q.y, 6.0 * q.z, 3, 0.6, 17);
    const double latitude = std::abs(2.0 * v - 1.0);
    const DVec3 sea = mixColors(DVec3(0.02, 0.10, 0.26), DVec3(0.06, 0.32, 0.48), 1.0 + land / 0.10);
    DVec3 ground = mixColors(DVec3(0.42, 0.34, 0.13), DVec3(0.10, 0.27, 0.07), (latitude - 0.18) / 0.22 + rough - 0.5);
    ground = mixColors(ground, DVec3(0.30, 0.20, 0.12), (land - 0.05) / 0.09);
    DVec3 color = mixColors(sea, ground, smoothStep(-0.003, 0.003, land));
    color = mixColors(color, DVec3(0.86, 0.90, 0.93), smoothStep(0.80, 0.86, latitude + 0.16 * (rough - 0.5)));
    // Every 15 degrees; a meridian's line keeps its width towards the poles.
    const auto toLine = [](double turns, double lines) {
      return std::abs(turns * lines - std::round(turns * lines)) / lines;
    };
    const double meridian = toLine(u, 24.0) * 2.0 * std::max(radius, 0.05);
    const double line = 1.0 - smoothStep(0.0012, 0.0030, std::min(meridian, toLine(v, 12.0)));
    return mixColors(color, DVec3(0.80, 0.74, 0.55), 0.55 * line);
  });
}

/// What light leaves of the floor's colour, relative to where nothing stands in the way.
double litFraction(double key, double sky) {
  const double full_key = kKeyRadiance * kKeyDirection.y;
  return (full_key * key + (kSkyRadiance + 0.3 * kFillRadiance) * sky) /
         (full_key + kSkyRadiance + 0.3 * kFillRadiance);
}

/// Rings of light and dark stones about the middle, with joints between and a band of brass along the rim.
/// x, z  metres from the middle; grain  about 1, the unevenness of stone there
DVec3 floorPattern(double x, double z, double grain) {
  constexpr double kRing = 0.65;
  const DVec3 light_stone(0.58, 0.53, 0.45);
  const DVec3 dark_stone(0.25, 0.235, 0.225);
  const double radius = std::sqrt(x * x + z * z);
  if (radius > kDaisRadius - 0.40) {
    const double from_band = std::abs(radius - (kDaisRadius - 0.20));
    return mixColors(DVec3(0.42, 0.24, 0.07), light_stone * grain, smoothStep(0.07, 0.08, from_band));
  }
  const double ring_at = radius / kRing;
  const int ring = static_cast<int>(ring_at);
  const int stones = 12 * ((ring + 2) / 2);
  const double along = (std::atan2(x, z) / (2.0 * kPi) + 0.5) * stones + 0.5 * ring;
  const int index = static_cast<int>(along) % stones;
  const double tone = 0.9 + 0.2 * hashFraction(ring, index, 0, 9);
  const double joint = std::min(std::abs(ring_at - std::round(ring_at)) * kRing,
                                std::abs(along - std::round(along)) / stones * 2.0 * kPi * radius);
  const DVec3 stone = (ring + index) % 2 == 0 ? dark_stone : light_stone;
  return stone * (tone * grain * (0.45 + 0.55 * smoothStep(0.006, 0.016, joint)));
}

Image8 paintFloor(const FloorLight& light) {
  // Noise is slow and the grain is fine but soft: a table of it, repeated, will do.
  constexpr int kGrainSide = 512;
  constexpr double kGrainMetres = 2.9;
  LightMap grain{kGrainSide, {}};
  for (int j = 0; j < kGrainSide; ++j)
    for (int i = 0; i < kGrainSide; ++i)
      grain.values.push_back(
          static_cast<float>(0.86 + 0.28 * fractalNoise(i * 9.0 / kGrainSide, j * 9.0 / kGrainSide, 0.0, 5, 0.6, 23)));
  const auto folded = [](double metres) {  // to and fro, so that the table's edges meet
    const double t = metres / kGrainMetres;
    return std::abs(t - 2.0 * std::round(0.5 * t));
  };
  return paintImage(1536, 1536, [&](double u, double v) {
    const double x = kFloorSide * (u - 0.5);
    const double z = kFloorSide * (v - 0.5);
    if (x * x + z * z > (kDaisRadius + 0.05) * (kDaisRadius + 0.05)) return DVec3(0.5);  // beyond the disc
    return floorPattern(x, z, grain.at(folded(x), folded(z))) * litFraction(light.key.at(u, v), light.sky.at(u, v));
  });
}

// Composition -----------------------------------------------------------------------------------------------------

/// A top face at `height` with the shadows of what is there painted into it.
void addLitSquare(Arrangement& a, double x, double z, double height, double side, double turn, const Material& like) {
  const FloorArea area{height, x, z, side * 1.5, 256};  // a turned square needs its diagonal
  const FloorLight light = a.lightOn(area);
  Material material = like;
  material.base_color_texture.texture =
      a.addTexture(like.name + " shadows", paintImage(256, 256, [&](double u, double v) {
                     return DVec3(litFraction(light.key.at(u, v), light.sky.at(u, v)));
                   }));
  material.base_color_texture.wrap_u = Wrap::kClamp;
  material.base_color_texture.wrap_v = Wrap::kClamp;
  const DMat4 world_from_object = placed(x, height, z, 1.0, turn);
  const auto shape = [&](int detail) {
    mesh::Mesh top = gridSurface({8 * detail, 8 * detail, false, false}, [&](double u, double v) {
      return SurfacePoint{DVec3(side * (u - 0.5), 0.0, side * (v - 0.5)), DVec3(0.0, 1.0, 0.0)};
    });
    for (std::size_t i = 0; i < top.vertexCount(); ++i) {
      const DVec3 world(world_from_object * DVec4(DVec3(top.positions[i]), 1.0));
      top.texcoords[i] = Vec2((world.x - x) / area.side + 0.5, (world.z - z) / area.side + 0.5);
    }
    return top;
  };
  a.add(a.addMesh(shape), a.addMaterial(material), world_from_object);
}

void addTeapotOnPlinth(Arrangement& a) {
  constexpr double kX = -1.95;
  constexpr double kZ = 0.95;
  constexpr double kSide = 1.9;
  constexpr double kTurn = 0.32;
  Material glaze = plain("glaze", Vec3(0.05F, 0.25F, 0.30F), 0.14F, 140.0F);
  glaze.double_sided = true;
  a.add(a.addMesh([](int detail) { return teapotMesh(12 * detail); }), a.addMaterial(glaze),
        placed(kX, kPlinthHeight, kZ, 0.46, kTurn));
  const Material stone = solid("plinth", Solid::kMarble, Vec3(0.62F, 0.52F, 0.42F), Vec3(0.34F, 0.20F, 0.14F), 1.4F);
  addLitSquare(a, kX, kZ, kPlinthHeight, kSide, kTurn, stone);
  const double half = 0.5 * kSide;
  const std::array<std::array<double, 2>, 4> square = {{{-half, half}, {half, half}, {half, -half}, {-half, -half}}};
  // Its top face lies just below the painted one.
  a.add(a.addMesh([&](int) { return prismMesh(square, 0.0, kPlinthHeight - 0.004); }), a.addMaterial(stone),
        placed(kX, 0.0, kZ, 1.0, kTurn));
}

void addKnotOnColumn(Arrangement& a) {
  constexpr double kX = 0.15;
  constexpr double kZ = -1.55;
  TorusKnot knot;
  knot.tube_radius = 0.42;
  // The knot stands on its edge and is turned a little, so that one can see through it.
  const DMat4 stand =
      placed(kX, kColumnHeight + 1.17, kZ, 0.40, -0.35) * DMat4(DVec4(1.0, 0.0, 0.0, 0.0), DVec4(0.0, 0.0, 1.0, 0.0),
                                                                DVec4(0.0, -1.0, 0.0, 0.0), DVec4(0.0, 0.0, 0.0, 1.0));
  a.add(a.addMesh([&](int detail) { return torusKnotMesh(knot, 320 * detail, 28 * detail); }),
        a.addMaterial(whiteMarble()), stand);
  const std::uint32_t marble =
      a.addMaterial(solid("column marble", Solid::kMarble, Vec3(0.78F, 0.74F, 0.68F), Vec3(0.46F, 0.40F, 0.36F), 0.9F));
  a.add(a.addMesh(columnShaft), marble, placed(kX, 0.0, kZ));
  a.add(a.addMesh(columnEnds), marble, placed(kX, 0.0, kZ));
}

void addGlobe(Arrangement& a) {
  constexpr double kX = 2.05;
  constexpr double kZ = 0.75;
  Material globe = plain("globe", Vec3(1.0F), 0.10F, 90.0F);
  globe.base_color_texture.texture = a.addTexture("globe", paintGlobe());
  globe.base_color_texture.wrap_v = Wrap::kClamp;
  const double tilt = radians(-18.0);
  const DMat4 tilted(DVec4(std::cos(tilt), std::sin(tilt), 0.0, 0.0), DVec4(-std::sin(tilt), std::cos(tilt), 0.0, 0.0),
                     DVec4(0.0, 0.0, 1.0, 0.0), DVec4(0.0, 0.0, 0.0, 1.0));
  a.add(a.addMesh([](int detail) { return globeMesh(96 * detail, 48 * detail); }), a.addMaterial(globe),
        placed(kX, 1.24, kZ, 0.84) * tilted * placed(0.0, 0.0, 0.0, 1.0, 3.3));
  const std::uint32_t wood =
      a.addMaterial(solid("stand wood", Solid::kWood, Vec3(0.36F, 0.17F, 0.07F), Vec3(0.16F, 0.07F, 0.03F), 7.0F));
  a.add(a.addMesh(globeStand), wood, placed(kX, 0.0, kZ));
}

void addVase(Arrangement& a) {
  const std::uint32_t wood =
      a.addMaterial(solid("vase wood", Solid::kWood, Vec3(0.62F, 0.38F, 0.17F), Vec3(0.30F, 0.14F, 0.05F), 9.0F));
  a.add(a.addMesh(vase), wood, placed(2.75, 0.0, -1.65, 1.12));
}

void addPawns(Arrangement& a) {
  const std::uint32_t shape = a.addMesh(pawn);
  const std::uint32_t ivory = a.addMaterial(plain("ivory", Vec3(0.80F, 0.70F, 0.50F), 0.08F, 80.0F));
  const std::uint32_t ebony = a.addMaterial(plain("ebony", Vec3(0.045F, 0.035F, 0.035F), 0.12F, 90.0F));
  a.add(shape, ivory, placed(-3.85, 0.0, -0.75, 1.2));
  a.add(shape, ebony, placed(-1.75, 0.0, -2.1, 1.25));
}

void addSmallThings(Arrangement& a) {
  Material ruby = plain("ruby", Vec3(0.50F, 0.02F, 0.06F), 0.35F, 200.0F);
  ruby.shading = Shading::kFlat;
  // The stone lies on a facet of its pavilion.
  const double lean = std::atan2(0.56, 0.52 * std::cos(kPi / 8.0));
  const DMat4 leaning(DVec4(1.0, 0.0, 0.0, 0.0), DVec4(0.0, std::cos(lean), std::sin(lean), 0.0),
                      DVec4(0.0, -std::sin(lean), std::cos(lean), 0.0), DVec4(0.0, 0.0, 0.0, 1.0));
  a.add(a.addMesh(gem), a.addMaterial(ruby),
        placed(0.45, 0.0, 2.0, 0.95, -2.4) * leaning * placed(0.0, 0.0, 0.0, 1.0, kPi / 8.0));
  const Material checker =
      solid("checker", Solid::kChecker, Vec3(0.80F, 0.76F, 0.66F), Vec3(0.62F, 0.20F, 0.05F), 4.0F);
  a.add(a.addMesh([](int) { return boxMesh(DVec3(-0.374, 0.0, -0.374), DVec3(0.374, 0.748, 0.374)); }),
        a.addMaterial(checker), placed(3.55, 0.0, 1.2, 0.75, 0.5));
}

void addDais(Arrangement& a) {
  const FloorArea area{0.0, 0.0, 0.0, kFloorSide, 1024};
  const FloorLight light = a.lightOn(area);
  Material floor = plain("floor", Vec3(1.0F), 0.03F, 40.0F);
  floor.base_color_texture.texture = a.addTexture("floor", paintFloor(light));
  floor.base_color_texture.wrap_u = Wrap::kClamp;
  floor.base_color_texture.wrap_v = Wrap::kClamp;
  a.add(a.addMesh(floorDisc), a.addMaterial(floor), DMat4(1.0));
  a.add(a.addMesh(daisRim), a.addMaterial(plain("slab", Vec3(0.50F, 0.46F, 0.40F), 0.03F, 30.0F)), DMat4(1.0));
  a.add(a.addMesh(daisStep), a.addMaterial(plain("step", Vec3(0.17F, 0.16F, 0.16F), 0.05F, 30.0F)), DMat4(1.0));
}

}  // namespace

Scene buildGallery(const BuiltinArguments& arguments) {
  Arrangement a(arguments.whole("detail"));
  addTeapotOnPlinth(a);
  addKnotOnColumn(a);
  addGlobe(a);
  addVase(a);
  addPawns(a);
  addSmallThings(a);
  addDais(a);

  Scene scene = std::move(a.scene());
  scene.lights.push_back({Vec3(kKeyDirection), static_cast<float>(kKeyRadiance) * Vec3(1.0F, 0.96F, 0.90F)});
  scene.lights.push_back(
      {Vec3(glm::normalize(DVec3(0.85, 0.30, 0.45))), static_cast<float>(kFillRadiance) * Vec3(0.9F, 1.0F, 1.15F)});
  scene.ambient.sky = static_cast<float>(kSkyRadiance) * Vec3(0.93F, 0.98F, 1.08F);
  scene.ambient.ground = Vec3(0.12F, 0.105F, 0.09F);
  scene.background = Vec3(0.60F, 0.66F, 0.72F);

  Camera camera;
  camera.name = "visitor";
  camera.eye = DVec3(1.5, 3.9, 12.6);
  camera.target = DVec3(0.0, 1.35, -0.1);
  camera.vertical_fov_rad = radians(29.0);
  scene.cameras.push_back(camera);
  return scene;
}

}  // namespace sheaf::scenes
