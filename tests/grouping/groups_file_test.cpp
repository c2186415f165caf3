#include "grouping/groups_file.h"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/error.h"
#include "grouping/linear_groups.h"
#include "grouping/planar_groups.h"
#include "tests/grouping/reseal.h"
#include "tests/grouping/shapes.h"
#include "tests/temp_folder.h"

namespace sheaf::grouping {
namespace {

std::vector<VertexGroups> assortedGroups() {
  std::mt19937 rng(0xf11e);
  const mesh::Mesh ball = lumpyBall(rng, 12, 16, 0.01F);
  PlanarOptions quadric;
  quadric.metric = Metric::kQuadric;
  quadric.planes = axisAndDodecahedronPlanes();
  LinearOptions segments;
  segments.segment_only = true;
  quadric.epsilon = segments.epsilon = 0.02;
  PlanarOptions fallback;
  fallback.metric = Metric::kQuadric;
  return {groupPlanar(ball, {}), groupPlanar(ball, quadric),  groupPlanar(randomPoints(rng, 100), fallback),
          groupLinear(ball, {}), groupLinear(ball, segments), groupPlanar({}, {})};
}

VertexGroups smallGroups(GroupKind kind) {
  std::mt19937 rng(0xf11f);
  mesh::Mesh mesh = latticePoints(rng, 12, 2);
  for (std::uint32_t v = 0; v + 3 < 12; ++v) mesh.triangles.push_back({v, v + 1, v + 2});  // 11 is unused
  LinearOptions linear;
  linear.epsilon = 0.1;
  return kind == GroupKind::kPlane ? groupPlanar(mesh, {}) : groupLinear(mesh, linear);
}

}  // namespace

TEST_CASE("grouping/groups_file: what is loaded equals what was saved") {
  for (const VertexGroups& groups : assortedGroups()) {
    CHECK(decodeGroups(encodeGroups(groups), "x") == groups);
  }
  const auto path =
      std::filesystem::temp_directory_path() / ("groups_file_test." + std::to_string(getpid()) + ".sheaf");
  VertexGroups groups = assortedGroups()[0];
  groups.mesh_checksum = 0x12345678;
  saveGroups(path, groups);
  CHECK(loadGroups(path) == groups);
  std::filesystem::remove(path);
  CHECK_THROWS_AS(loadGroups(path), Error);
}

TEST_CASE("grouping/groups_file: quantised parameters keep within half a step, and a second saving changes nothing") {
  for (const VertexGroups& groups : assortedGroups())
    for (const int bits : {1, 10, 16, 24}) {
      CAPTURE(bits);
      GroupsFileOptions options;
      options.parameter_bits = bits;
      const VertexGroups loaded = decodeGroups(encodeGroups(groups, options), "x");
      CHECK(loaded.state == groups.state);
      CHECK(loaded.members == groups.members);
      const double steps = std::ldexp(1.0, bits) - 1.0;
      for (const VertexGroup& g : groups.groups)
        for (std::uint32_t m = g.first_member; m < g.first_member + g.member_count; ++m) {
          CHECK(std::abs(loaded.s[m] - groups.s[m]) <= (0.5 / steps + 1e-6) * (g.s_max - g.s_min));
          CHECK(std::abs(loaded.t[m] - groups.t[m]) <= (0.5 / steps + 1e-6) * (g.t_max - g.t_min));
        }
      CHECK(encodeGroups(loaded, options) == encodeGroups(groups, options));
    }
  const VertexGroups groups = assortedGroups()[0];
  GroupsFileOptions options;
  options.parameter_bits = 10;
  CHECK(encodeGroups(groups, options).size() < encodeGroups(groups).size());
}

TEST_CASE("grouping/groups_file: a file with any byte changed is refused") {
  for (const GroupKind kind : {GroupKind::kPlane, GroupKind::kLine}) {
    const std::string good = encodeGroups(smallGroups(kind));
    REQUIRE_NOTHROW(decodeGroups(good, "x"));
    for (std::size_t i = 0; i < good.size(); ++i)
      for (const int change : {0x01, 0x80, 0xFF}) {
        std::string bad = good;
        bad[i] = static_cast<char>(bad[i] ^ change);
        CAPTURE(i);
        CHECK_THROWS_AS(decodeGroups(bad, "x"), Error);
      }
  }
}

TEST_CASE("grouping/groups_file: a forged file is refused or consistent") {
  for (const GroupKind kind : {GroupKind::kPlane, GroupKind::kLine})
    for (const int bits : {0, 12}) {
      GroupsFileOptions options;
      options.parameter_bits = bits;
      const std::string good = encodeGroups(smallGroups(kind), options);
      int refused = 0;
      for (std::size_t i = kContentAt; i < good.size(); ++i)
        for (int change = 1; change < 256; change += 2) {
          std::string bad = good;
          bad[i] = static_cast<char>(bad[i] ^ change);
          CAPTURE(i);
          CAPTURE(change);
          try {
            const VertexGroups loaded = decodeGroups(resealed(bad), "x");
            CHECK(findInconsistency(loaded) == "");
          } catch (const Error& error) {
            CHECK(error.code() == ErrorCode::kBadInput);
            ++refused;
          }
        }
      CHECK(refused > 0);
    }
}

TEST_CASE("grouping/groups_file: a forged frame that is not orthonormal, or a member that is nowhere, is refused") {
  const auto refusal = [](const VertexGroups& forged) {
    try {
      decodeGroups(encodeGroups(forged), "x");
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::kBadInput);
      return std::string(error.what());
    }
    return std::string();
  };
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();
  const VertexGroups good = smallGroups(GroupKind::kPlane);
  REQUIRE(good.planes.size() > 1);
  REQUIRE(refusal(good) == "");
  const Vec3 normal = good.planes[1].normal, s = good.planes[1].axis_s, t = good.planes[1].axis_t;
  for (const PlaneFrame& frame :
       {PlaneFrame{Vec3(kNan), s, t}, PlaneFrame{normal * kInf, s, t}, PlaneFrame{Vec3(0.0F), s, t},
        PlaneFrame{-normal, s, t}, PlaneFrame{normal, Vec3(kNan), t}, PlaneFrame{normal, 1.001F * s, t},
        PlaneFrame{normal, s, s + t}, PlaneFrame{normal, t, s}, PlaneFrame{normal, s, Vec3(1e30F)}}) {
    VertexGroups forged = good;
    forged.planes[1] = frame;
    CHECK(refusal(forged) == "x: damaged vertex groups: plane 1 has no orthonormal frame");
  }
  for (const GroupKind kind : {GroupKind::kPlane, GroupKind::kLine})
    for (const float at : {kNan, kInf, -kInf}) {
      VertexGroups forged = smallGroups(kind);
      REQUIRE(!forged.members.empty());
      forged.s[0] = at;
      CHECK(refusal(forged) == fmt::format("x: damaged vertex groups: member {} lies nowhere", forged.members[0]));
      forged = smallGroups(kind);
      forged.groups[0].base.y = at;
      CHECK(refusal(forged) == fmt::format("x: damaged vertex groups: member {} lies nowhere", forged.members[0]));
    }
}

TEST_CASE("grouping/groups_file: a truncated or extended file is refused") {
  const std::string good = encodeGroups(smallGroups(GroupKind::kPlane));
  for (std::size_t size = 0; size < good.size(); ++size) {
    CAPTURE(size);
    CHECK_THROWS_AS(decodeGroups(good.substr(0, size), "x"), Error);
    if (size < kContentAt) continue;
    std::string forged = good.substr(0, size);
    const std::uint64_t content = size - kContentAt;
    std::memcpy(forged.data() + 12, &content, sizeof content);
    CHECK_THROWS_AS(decodeGroups(resealed(forged), "x"), Error);
  }
  CHECK_THROWS_AS(decodeGroups(good + "x", "x"), Error);
}

TEST_CASE("grouping/groups_file: refusals name the file and the reason") {
  CHECK_THROWS_WITH_AS(decodeGroups("solid cube", "cube.stl"), "cube.stl: is not a file of vertex groups", Error);
  std::string newer = encodeGroups(smallGroups(GroupKind::kPlane));
  newer[8] = 9;
  try {
    decodeGroups(newer, "a.sheaf");
    FAIL("accepted");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::kUnsupported);
    CHECK(std::string(error.what()) == "a.sheaf: has version 9 of vertex groups, this reads version 2");
  }
}

TEST_CASE("grouping/groups_file: saved groups are taken only for their own mesh, as it is numbered") {
  std::mt19937 rng(0xf121);
  const mesh::Mesh mesh = lumpyBall(rng, 6, 8);
  const TempFolder folder;
  VertexGroups groups = groupPlanar(mesh, {});
  groups.mesh_checksum = meshChecksum(mesh);
  saveGroups(folder.file("a.sheaf"), groups);
  CHECK(loadGroups(folder.file("a.sheaf"), mesh) == groups);
  const auto refusal = [&](const mesh::Mesh& other) {
    try {
      loadGroups(folder.file("a.sheaf"), other);
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::kBadInput);
      return std::string(error.what());
    }
    return std::string();
  };
  mesh::Mesh moved = mesh, turned = mesh, renumbered = mesh, larger = mesh;
  moved.positions[7].x += 1e-3F;
  std::swap(turned.triangles[3][0], turned.triangles[3][1]);
  std::swap(renumbered.positions[2], renumbered.positions[3]);
  larger.positions.push_back(Vec3(0.0F));
  for (const mesh::Mesh& other : {moved, turned, renumbered})
    CHECK(refusal(other).find("a.sheaf: belongs to another mesh: as many vertices") != std::string::npos);
  CHECK(refusal(larger).find("its groups are of") != std::string::npos);
}

TEST_CASE("grouping/groups_file: saved groups with a vertex that is in no group at another place are refused") {
  std::mt19937 rng(0xf122);
  mesh::Mesh mesh = lumpyBall(rng, 12, 16, 0.01F);
  mesh.positions.emplace_back(0.0F);  // unused
  const TempFolder folder;
  PlanarOptions options;
  options.epsilon = 0.001;
  VertexGroups good = groupPlanar(mesh, options);
  good.mesh_checksum = meshChecksum(mesh);
  for (const VertexState state : {VertexState::kFree, VertexState::kDefining, VertexState::kUnused}) {
    const auto v = static_cast<std::size_t>(std::ranges::find(good.state, state) - good.state.begin());
    REQUIRE(v < good.state.size());
    for (const float x : {std::numeric_limits<float>::quiet_NaN(), 1e38F,
                          std::nextafter(mesh.positions[v].x, std::numeric_limits<float>::infinity())}) {
      VertexGroups forged = good;
      forged.positions[v].x = x;
      saveGroups(folder.file("a.sheaf"), forged);
      CHECK_NOTHROW(loadGroups(folder.file("a.sheaf")));
      CHECK_THROWS_WITH_AS(loadGroups(folder.file("a.sheaf"), mesh),
                           fmt::format("{}: belongs to another mesh: vertex {} is in no group, but not where the mesh "
                                       "has it",
                                       folder.file("a.sheaf"), v)
                               .c_str(),
                           Error);
    }
  }
}

TEST_CASE("grouping/groups_file: unused vertices keep their bits, also those of no number") {
  std::mt19937 rng(0xf120);
  mesh::Mesh mesh = lumpyBall(rng, 6, 8);
  mesh.positions.push_back(Vec3(std::numeric_limits<float>::quiet_NaN()));
  VertexGroups groups = groupPlanar(mesh, {});
  groups.mesh_checksum = meshChecksum(mesh);
  const std::string bytes = encodeGroups(groups);
  CHECK(encodeGroups(decodeGroups(bytes, "x")) == bytes);
  const TempFolder folder;
  saveGroups(folder.file("a.sheaf"), groups);
  CHECK(encodeGroups(loadGroups(folder.file("a.sheaf"), mesh)) == bytes);
}

}  // namespace sheaf::grouping
