// tests/grouping/shapes: meshes and point sets for the grouping tests.
#pragma once

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include <random>

#include "mesh/mesh.h"
#include "tests/mesh/meshes.h"

namespace sheaf::grouping {

inline mesh::Mesh randomPoints(std::mt19937& rng, std::uint32_t count, const Vec3& size = Vec3(1.0F)) {
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  mesh::Mesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    const float x = unit(rng), y = unit(rng), z = unit(rng);
    mesh.positions.push_back(size * Vec3(x, y, z));
  }
  return mesh;
}

// Positions on a coarse lattice: many exact duplicates, coplanar and collinear triples.
inline mesh::Mesh latticePoints(std::mt19937& rng, std::uint32_t count, int steps) {
  std::uniform_int_distribution<int> cell(0, steps);
  mesh::Mesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    const int x = cell(rng), y = cell(rng), z = cell(rng);
    mesh.positions.push_back(Vec3(x, y, z) * 0.25F);
  }
  return mesh;
}

// Random positions and random triangles over them: non-manifold, slivers, faces through each other.
inline mesh::Mesh triangleSoup(std::mt19937& rng, std::uint32_t vertices, std::uint32_t faces) {
  mesh::Mesh mesh = randomPoints(rng, vertices);
  std::uniform_int_distribution<std::uint32_t> pick(0, vertices - 1);
  for (std::uint32_t f = 0; f < faces; ++f) {
    const std::uint32_t a = pick(rng), b = pick(rng), c = pick(rng);
    mesh.triangles.push_back({a, b, c});
  }
  return mesh;
}

// A closed, lumpy ball of rings x segments quads, its vertices shaken by `noise`.
inline mesh::Mesh lumpyBall(std::mt19937& rng, std::uint32_t rings, std::uint32_t segments, float noise = 0.0F) {
  std::uniform_real_distribution<float> shake(-noise, noise);
  mesh::Mesh mesh;
  const auto add = [&](double polar, double around) {
    const double r = 1.0 + 0.2 * std::sin(3.0 * around) * std::sin(polar) + 0.15 * std::cos(4.0 * polar);
    const float dx = shake(rng), dy = shake(rng), dz = shake(rng);
    mesh.positions.push_back(Vec3(DVec3(r * std::sin(polar) * std::cos(around), 1.3 * r * std::cos(polar),
                                        0.7 * r * std::sin(polar) * std::sin(around))) +
                             Vec3(dx, dy, dz));
  };
  add(0.0, 0.0);
  for (std::uint32_t i = 1; i < rings; ++i)
    for (std::uint32_t k = 0; k < segments; ++k) add(kPi * i / rings, 2.0 * kPi * k / segments);
  add(kPi, 0.0);
  const auto at = [&](std::uint32_t ring, std::uint32_t k) { return 1 + (ring - 1) * segments + k % segments; };
  const auto last = static_cast<std::uint32_t>(mesh.positions.size()) - 1;
  for (std::uint32_t k = 0; k < segments; ++k) {
    mesh.triangles.push_back({0, at(1, k + 1), at(1, k)});
    for (std::uint32_t i = 1; i + 1 < rings; ++i) {
      mesh.triangles.push_back({at(i, k), at(i, k + 1), at(i + 1, k)});
      mesh.triangles.push_back({at(i, k + 1), at(i + 1, k + 1), at(i + 1, k)});
    }
    mesh.triangles.push_back({at(rings - 1, k), at(rings - 1, k + 1), last});
  }
  return mesh;
}

// A round plate: two flat sides, each a fan, and a rim of squares between them. Front and back grow into hubs that have
// every face of the rim as a common neighbour.
inline mesh::Mesh plateOf(std::uint32_t steps) {
  mesh::Mesh plate;
  plate.positions = {{0.0F, 0.0F, 0.1F}, {0.0F, 0.0F, -0.1F}};
  for (std::uint32_t i = 0; i < steps; ++i) {
    const double phi = 2.0 * kPi * i / steps;
    for (const double z : {0.1, -0.1}) plate.positions.emplace_back(std::cos(phi), std::sin(phi), z);
  }
  for (std::uint32_t i = 0; i < steps; ++i) {
    const std::uint32_t a = 2 + 2 * i, b = 2 + 2 * ((i + 1) % steps);
    plate.triangles.insert(plate.triangles.end(), {{0, a, b}, {1, b + 1, a + 1}, {a, a + 1, b}, {b, a + 1, b + 1}});
  }
  return plate;
}

// A bowl whose curvature and faces change steadily from the middle outwards: 2 * side^2 faces.
inline mesh::Mesh bowl(std::uint32_t side) {
  mesh::Mesh mesh = mesh::makeGrid(side);
  for (Vec3& p : mesh.positions) {
    const float u = 2.0F * p.x - 1.0F, v = 2.0F * p.y - 1.0F;
    p.z = 0.3F * (u * u + v * v);
  }
  return mesh;
}

// A hilly field with an open border.
inline mesh::Mesh hills(std::mt19937& rng, std::uint32_t side, float height = 0.2F) {
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  mesh::Mesh mesh;
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x) {
      const float dx = 0.4F * unit(rng), dy = 0.4F * unit(rng), up = height * unit(rng);
      mesh.positions.emplace_back((float(x) + dx) / float(side), up, (float(y) + dy) / float(side));
    }
  for (std::uint32_t y = 0; y + 1 < side; ++y)
    for (std::uint32_t x = 0; x + 1 < side; ++x) {
      const std::uint32_t a = y * side + x, b = a + 1, c = a + side, d = c + 1;
      mesh.triangles.push_back({a, c, b});
      mesh.triangles.push_back({b, c, d});
    }
  return mesh;
}

/// A sheet of side x side vertices at place(u, v), u and v in [0, 1].
template <typename Place>
mesh::Mesh sheet(std::uint32_t side, const Place& place) {
  mesh::Mesh mesh;
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x)
      mesh.positions.push_back(place(static_cast<float>(x) / static_cast<float>(side - 1),
                                     static_cast<float>(y) / static_cast<float>(side - 1)));
  for (std::uint32_t y = 0; y + 1 < side; ++y)
    for (std::uint32_t x = 0; x + 1 < side; ++x) {
      const std::uint32_t a = y * side + x;
      mesh.triangles.push_back({a, a + 1, a + side});
      mesh.triangles.push_back({a + 1, a + side + 1, a + side});
    }
  return mesh;
}

/// Hills over the unit square, turned so that no axis is special.
inline mesh::Mesh tiltedHills(std::uint32_t side, double height) {
  const DMat3 turn(glm::rotate(DMat4(1.0), 0.7, glm::normalize(DVec3(1.0, 2.0, 3.0))));
  return sheet(side, [&](double u, double v) {
    return Vec3(turn * DVec3(u, v, height * std::sin(9.0 * u) * std::cos(7.0 * v)));
  });
}

}  // namespace sheaf::grouping
