// scenes/polygon_builder: faces of any number of corners into the triangles of a mesh, with every index checked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mesh/mesh.h"

namespace sheaf::scenes {

class PolygonBuilder {
 public:
  /// mesh  its positions are complete; triangles are appended
  explicit PolygonBuilder(mesh::Mesh& mesh) : mesh_(mesh) {}

  /// The first corner that is not a vertex of the mesh, or #corners if all are.
  std::size_t firstBadCorner(std::span<const std::int64_t> corners) const;

  /// Appends a face whose corners are all vertices. One with fewer than 3 corners is only counted.
  void addFace(std::span<const std::int64_t> corners);

  /// Appends the triangles of a strip, each second one turned round; stitches (a vertex twice) are left out.
  void addStrip(std::span<const std::int64_t> corners);

  /// "name: N faces left out ..." for what was odd.
  void reportTo(std::vector<std::string>& warnings, std::string_view name) const;

 private:
  mesh::Mesh& mesh_;
  std::size_t too_few_corners_ = 0;
  std::size_t tangled_ = 0;
  std::vector<Vec3> corner_positions_;
  std::vector<mesh::Triangle> corner_triangles_;
};

/// "refers to vertex 9, the mesh has 8 (0 to 7)"
std::string badIndexText(std::int64_t index, std::size_t vertex_count);

}  // namespace sheaf::scenes
