// tests/grouping/assorted_meshes: small meshes of every kind that clustering has to cope with.
#pragma once

#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "tests/grouping/shapes.h"
#include "tests/mesh/meshes.h"

namespace sheaf::grouping {

inline void append(mesh::Mesh& mesh, const mesh::Mesh& other, const Vec3& offset) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Vec3& p : other.positions) mesh.positions.push_back(p + offset);
  for (const mesh::Triangle& t : other.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

inline mesh::Mesh needles(std::mt19937& rng) {
  mesh::Mesh mesh = hills(rng, 12, 0.1F);
  for (Vec3& p : mesh.positions) p.x *= 1e-4F;
  return mesh;
}

inline mesh::Mesh severalPieces(std::mt19937& rng) {
  mesh::Mesh mesh = lumpyBall(rng, 8, 10, 0.03F);
  append(mesh, hills(rng, 6), Vec3(3.0F, 0.0F, 0.0F));
  append(mesh, mesh::makeCube(), Vec3(-3.0F, 0.0F, 0.0F));
  mesh.positions.push_back(Vec3(9.0F));  // unused
  return mesh;
}

inline mesh::Mesh badFaces(std::mt19937& rng) {
  mesh::Mesh mesh = hills(rng, 6);
  mesh.positions.push_back(Vec3(std::numeric_limits<float>::quiet_NaN()));
  mesh.positions.push_back(Vec3(std::numeric_limits<float>::infinity()));
  const auto nan = static_cast<std::uint32_t>(mesh.positions.size() - 2);
  mesh.triangles.push_back({0, 1, nan});
  mesh.triangles.push_back({0, 1, nan + 1});
  mesh.triangles.push_back({nan, nan, nan});
  mesh.triangles.push_back({0, 0, 1});
  mesh.triangles.push_back({3, 3, 3});
  mesh.triangles.push_back(mesh.triangles[7]);
  return mesh;
}

struct Named {
  const char* name;
  mesh::Mesh mesh;
};

inline std::vector<Named> assortedMeshes() {
  std::mt19937 rng(0xfaceU);
  std::vector<Named> meshes;
  meshes.push_back({"closed ball", lumpyBall(rng, 16, 20, 0.02F)});
  meshes.push_back({"hills", hills(rng, 14)});
  meshes.push_back({"planar grid", mesh::makeGrid(8)});
  meshes.push_back({"cube", mesh::makeCube()});
  meshes.push_back({"sphere", mesh::makeSphere(10, 12)});
  meshes.push_back({"soup", triangleSoup(rng, 40, 120)});
  meshes.push_back({"dense soup", triangleSoup(rng, 10, 150)});
  meshes.push_back({"needles", needles(rng)});
  meshes.push_back({"several pieces", severalPieces(rng)});
  meshes.push_back({"bad faces", badFaces(rng)});
  mesh::Mesh far = lumpyBall(rng, 10, 12);
  for (Vec3& p : far.positions) p = 40.0F * p + Vec3(1e6F, -1e6F, 1e6F);
  meshes.push_back({"far from the origin", std::move(far)});
  mesh::Mesh wound = lumpyBall(rng, 10, 12, 0.02F);
  for (mesh::Triangle& t : wound.triangles)
    if (rng() % 3 == 0) std::swap(t[0], t[1]);
  meshes.push_back({"inconsistent winding", std::move(wound)});
  meshes.push_back({"fan", mesh::makeFan(300)});
  return meshes;
}

}  // namespace sheaf::grouping
