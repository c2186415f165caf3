#include "grouping/clusters_file.h"

#include <doctest/doctest.h>

#include <limits>

#include "core/error.h"
#include "tests/grouping/reseal.h"
#include "tests/grouping/shapes.h"
#include "tests/temp_folder.h"

namespace sheaf::grouping {
namespace {

constexpr std::size_t kPlacesAt = kContentAt + 12;

FaceClusters clustersOf(const mesh::Mesh& mesh) {
  TaskPool pool(1);
  return clusterFaces(mesh, {}, pool);
}

// 18 faces in one tree, with two shapes or so, and two faces by themselves.
mesh::Mesh smallMesh() {
  std::mt19937 rng(0xf1c1);
  mesh::Mesh mesh = hills(rng, 4);
  const auto first = static_cast<std::uint32_t>(mesh.vertexCount());
  for (const float x : {3.0F, 4.0F, 5.0F, 6.0F, 7.0F, 8.0F}) mesh.positions.emplace_back(x, x * x, 0.0F);
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first + 3, first + 4, first + 5});
  return mesh;
}

std::string smallFile() {
  return encodeClusters(clustersOf(smallMesh()), smallMesh());
}

std::string refusalOf(const std::string& bytes, const mesh::Mesh& mesh = smallMesh()) {
  try {
    decodeClusters(bytes, mesh, "a.sheaf");
  } catch (const Error& e) {
    CHECK((e.code() == ErrorCode::kBadInput || e.code() == ErrorCode::kUnsupported));
    return e.what();
  }
  return "";
}

template <typename Value>
std::string overwritten(std::string bytes, std::size_t at, Value value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
  return resealed(bytes);
}

// Whatever is let through must keep every promise.
void checkRefusedOrSound(const std::string& bytes, const mesh::Mesh& mesh) {
  try {
    const FaceClusters clusters = decodeClusters(bytes, mesh, "x");
    CHECK(findInconsistency(clusters) == "");
  } catch (const Error& e) {
    CHECK(e.code() == ErrorCode::kBadInput);
  }
  try {
    const FaceClusters alone = decodeClusters(bytes, "x");
    CHECK(findInconsistency(alone) == "");
  } catch (const Error& e) {
    CHECK(e.code() == ErrorCode::kBadInput);
  }
}

}  // namespace

TEST_CASE("grouping/clusters_file: what is loaded equals what was saved") {
  std::mt19937 rng(0xf1c2);
  mesh::Mesh one;
  one.positions = {{0.0F, 0.0F, 0.0F}, {1.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F}};
  one.triangles = {{0, 1, 2}};
  for (const mesh::Mesh& mesh :
       {lumpyBall(rng, 30, 40, 0.01F), hills(rng, 25), triangleSoup(rng, 40, 200), one, mesh::Mesh{}}) {
    const FaceClusters clusters = clustersOf(mesh);
    CHECK(decodeClusters(encodeClusters(clusters, mesh), mesh, "x") == clusters);
  }
  const TempFolder folder;
  const mesh::Mesh small = smallMesh();
  CHECK(decodeClusters(smallFile(), "x") == clustersOf(small));
  saveClusters(folder.file("a.sheaf"), clustersOf(small), small);
  CHECK(loadClusters(folder.file("a.sheaf"), small) == clustersOf(small));
}

TEST_CASE("grouping/clusters_file: a file with any byte changed is refused") {
  const mesh::Mesh mesh = smallMesh();
  const std::string bytes = smallFile();
  for (std::size_t i = 0; i < bytes.size(); ++i)
    for (const int flip : {0x01, 0x80, 0xFF}) {
      std::string damaged = bytes;
      damaged[i] = static_cast<char>(damaged[i] ^ flip);
      CHECK_THROWS_AS(decodeClusters(damaged, mesh, "x"), Error);
    }
}

TEST_CASE("grouping/clusters_file: a forged file is refused or sound") {
  const mesh::Mesh mesh = smallMesh();
  const std::string bytes = smallFile();
  for (std::size_t i = kContentAt; i < bytes.size(); ++i)
    for (int flip = 1; flip < 256; flip = 2 * flip + 1) {
      CAPTURE(i);
      std::string damaged = bytes;
      damaged[i] = static_cast<char>(damaged[i] ^ flip);
      checkRefusedOrSound(resealed(damaged), mesh);
    }
  std::mt19937 rng(0xf1c3);
  for (int round = 0; round < 3000; ++round) {
    CAPTURE(round);
    std::string damaged = bytes;
    for (int k = 0; k < 3; ++k) damaged[kContentAt + rng() % (bytes.size() - kContentAt)] = static_cast<char>(rng());
    checkRefusedOrSound(resealed(damaged), mesh);
  }
}

TEST_CASE("grouping/clusters_file: a truncated or extended file is refused, sealed anew or not") {
  const mesh::Mesh mesh = smallMesh();
  const std::string bytes = smallFile();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    CAPTURE(size);
    const std::string cut = bytes.substr(0, size);
    CHECK_THROWS_AS(decodeClusters(cut, mesh, "x"), Error);
    if (size < kContentAt) continue;
    const std::string shorter = overwritten(cut, 12, static_cast<std::uint64_t>(size - kContentAt));
    CHECK_THROWS_AS(decodeClusters(shorter, mesh, "x"), Error);
  }
  const std::string longer = overwritten(bytes + '\0', 12, static_cast<std::uint64_t>(bytes.size() + 1 - kContentAt));
  CHECK(refusalOf(longer) == "a.sheaf: damaged face clusters: 1 bytes too many");
}

TEST_CASE("grouping/clusters_file: refusals name the file and the reason") {
  const FaceClusters clusters = clustersOf(smallMesh());
  const std::string bytes = smallFile();
  const std::uint32_t faces = clusters.faceCount(), merges = static_cast<std::uint32_t>(clusters.children.size());
  REQUIRE(faces == 20);
  const std::size_t costs_at = kPlacesAt + 4 * clusters.nodeCount(), shapes_at = bytes.size() - sizeof(ClusterShape);
  CHECK(refusalOf("SHEAFGRP" + bytes.substr(8)) == "a.sheaf: is not a file of face clusters");
  CHECK(refusalOf(overwritten(bytes, 8, 9U)) == "a.sheaf: has version 9 of face clusters, this reads version 2");
  CHECK(refusalOf(overwritten(bytes, kContentAt, 0x7FFFFFFFU)) ==
        "a.sheaf: damaged face clusters: more faces than bytes");
  CHECK(refusalOf(overwritten(bytes, kContentAt + 4, 0xFFFFFFFFU)) ==
        "a.sheaf: damaged face clusters: more faces than bytes");
  CHECK(refusalOf(overwritten(bytes, kPlacesAt, 2 * merges)).find("node 0 is in merge 17 of 17") != std::string::npos);
  // The node that is twice there takes the place of another.
  std::uint32_t second = 0;
  std::memcpy(&second, bytes.data() + kPlacesAt + 4, sizeof second);
  CHECK(refusalOf(overwritten(bytes, kPlacesAt, second)).find("has more than two parts") != std::string::npos);
  CHECK(refusalOf(overwritten(bytes, kPlacesAt, kNoIndex)).find("takes node") != std::string::npos);
  CHECK(refusalOf(overwritten(bytes, costs_at, std::numeric_limits<float>::quiet_NaN())) ==
        "a.sheaf: damaged face clusters: a cost is no number");
  CHECK(refusalOf(overwritten(bytes, shapes_at, std::numeric_limits<float>::infinity())).find("is not possible") !=
        std::string::npos);
  CHECK(refusalOf(overwritten(bytes, shapes_at, 1e30F)).find("is not where the mesh is") != std::string::npos);
}

TEST_CASE("grouping/clusters_file: clusters of another mesh are refused, those of another numbering are not") {
  const std::string bytes = smallFile();
  mesh::Mesh fewer = smallMesh();
  fewer.triangles.pop_back();
  CHECK(refusalOf(bytes, fewer) == "a.sheaf: belongs to another mesh: its clusters are of 20 faces, the mesh has 19");
  CHECK(refusalOf(bytes, {}) == "a.sheaf: belongs to another mesh: its clusters are of 20 faces, the mesh has 0");
  const std::string other_corners = "a.sheaf: belongs to another mesh: as many faces, but other corners";
  mesh::Mesh moved = smallMesh();
  moved.positions[5].y = std::nextafter(moved.positions[5].y, 9.0F);
  CHECK(refusalOf(bytes, moved) == other_corners);
  mesh::Mesh reordered = smallMesh();
  std::swap(reordered.triangles[3], reordered.triangles[4]);
  CHECK(refusalOf(bytes, reordered) == other_corners);
  mesh::Mesh turned = smallMesh();
  std::swap(turned.triangles[3][0], turned.triangles[3][1]);
  CHECK(refusalOf(bytes, turned) == other_corners);
  mesh::Mesh renumbered = smallMesh();
  std::swap(renumbered.positions[2], renumbered.positions[9]);
  for (mesh::Triangle& t : renumbered.triangles)
    for (std::uint32_t& v : t) v = v == 2 ? 9 : v == 9 ? 2 : v;
  renumbered.positions.emplace_back(77.0F);
  CHECK(refusalOf(bytes, renumbered) == "");
  // A forged number of faces does not get past the mesh either.
  CHECK(refusalOf(overwritten(bytes, kContentAt, 19U)).find("belongs to another mesh") != std::string::npos);
}

}  // namespace sheaf::grouping
