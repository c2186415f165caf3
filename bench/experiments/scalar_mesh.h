// bench/experiments/scalar_mesh: a mesh as scalar_kernels.h transforms it.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/experiments/scalar_kernels.h"
#include "core/math.h"
#include "grouping/vertex_groups.h"

namespace sheaf::experiments {

/// Owns what a ScalarMesh refers to. The vertices are renumbered: retained ones, then by group.
struct ScalarArrays {
  std::vector<Float4> retained4;
  std::vector<Float3> retained3;
  std::vector<ScalarPlane> planes;
  std::vector<ScalarLine> lines;
  std::vector<Float2> plane_parameters;
  std::vector<float> line_parameters;

  ScalarMesh view() const;
  std::size_t vertexCount() const { return retained4.size() + plane_parameters.size() + line_parameters.size(); }
};

/// groups  with axis planes, or lines; no vertex may have been moved away from its group
ScalarArrays groupedArrays(const grouping::VertexGroups& groups);
/// The same vertices at the same places in the same order, all retained.
ScalarArrays ungroupedArrays(const grouping::VertexGroups& groups);

/// Multiplications and additions of one transform; differences V2' - V1' are additions.
struct Arithmetic {
  std::uint64_t multiplications = 0;
  std::uint64_t additions = 0;
};
Arithmetic arithmeticOf(const ScalarMesh& mesh, ScalarForm form);

/// Model to clip space: perspective, or affine where the form takes that for granted.
Mat4 scalarMatrix(ScalarForm form);

}  // namespace sheaf::experiments
