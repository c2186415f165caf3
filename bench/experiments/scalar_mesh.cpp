#include "bench/experiments/scalar_mesh.h"

#include <array>
#include <glm/gtc/matrix_transform.hpp>

namespace sheaf::experiments {
namespace {

using grouping::VertexGroups;
using grouping::VertexState;

void addRetained(const Vec3& p, ScalarArrays& to) {
  to.retained4.push_back({p.x, p.y, p.z, 1.0F});
  to.retained3.push_back({p.x, p.y, p.z});
}

bool isRetained(VertexState state) {
  return state == VertexState::kFree || state == VertexState::kDefining;
}

std::uint32_t axisOf(const Vec3& unit) {
  return unit.x != 0.0F ? 0 : unit.y != 0.0F ? 1 : 2;
}

}  // namespace

ScalarMesh ScalarArrays::view() const {
  return {.retained4 = retained4.data(),
          .retained3 = retained3.data(),
          .retained_count = static_cast<std::uint32_t>(retained4.size()),
          .planes = planes.data(),
          .plane_count = static_cast<std::uint32_t>(planes.size()),
          .lines = lines.data(),
          .line_count = static_cast<std::uint32_t>(lines.size()),
          .plane_parameters = plane_parameters.data(),
          .line_parameters = line_parameters.data()};
}

ScalarArrays groupedArrays(const VertexGroups& groups) {
  ScalarArrays to;
  std::vector<std::uint32_t> number(groups.state.size(), 0);
  for (std::size_t v = 0; v < groups.state.size(); ++v)
    if (isRetained(groups.state[v])) {
      number[v] = static_cast<std::uint32_t>(to.retained4.size());
      addRetained(groups.positions[v], to);
    }
  for (const grouping::VertexGroup& g : groups.groups) {
    const std::uint32_t last = g.first_member + g.member_count;
    if (g.kind == grouping::GroupKind::kPlane) {
      to.planes.push_back({number[g.origin], axisOf(g.axis_s), axisOf(g.axis_t), g.member_count});
      for (std::uint32_t i = g.first_member; i < last; ++i) to.plane_parameters.push_back({groups.s[i], groups.t[i]});
    } else {
      to.lines.push_back({number[g.origin], number[g.end], g.member_count});
      for (std::uint32_t i = g.first_member; i < last; ++i) to.line_parameters.push_back(groups.s[i]);
    }
  }
  return to;
}

ScalarArrays ungroupedArrays(const VertexGroups& groups) {
  ScalarArrays to;
  for (std::size_t v = 0; v < groups.state.size(); ++v)
    if (isRetained(groups.state[v])) addRetained(groups.positions[v], to);
  for (const std::uint32_t v : groups.members) addRetained(groups.positions[v], to);
  return to;
}

Arithmetic arithmeticOf(const ScalarMesh& mesh, ScalarForm form) {
  constexpr std::array<Arithmetic, kScalarForms> kFull = {{{16, 12}, {16, 12}, {12, 12}, {9, 9}}};
  constexpr std::array<std::uint64_t, kScalarForms> kBuilt = {4, 3, 4, 3};
  const auto f = static_cast<std::size_t>(form);
  std::uint64_t on_planes = 0, on_lines = 0;
  for (std::uint32_t g = 0; g < mesh.plane_count; ++g) on_planes += mesh.planes[g].count;
  for (std::uint32_t g = 0; g < mesh.line_count; ++g) on_lines += mesh.lines[g].count;
  const std::uint64_t rebuilt = kBuilt[f] * (2 * on_planes + on_lines);
  return {mesh.retained_count * kFull[f].multiplications + rebuilt,
          mesh.retained_count * kFull[f].additions + rebuilt + kBuilt[f] * mesh.line_count};
}

Mat4 scalarMatrix(ScalarForm form) {
  const Mat4 turned = glm::rotate(Mat4(1.0F), 0.7F, glm::normalize(Vec3(0.3F, 1.0F, 0.2F)));
  const Mat4 affine = glm::translate(Mat4(1.0F), Vec3(0.2F, -0.1F, -4.0F)) * turned;
  if (form == ScalarForm::kRebuild3 || form == ScalarForm::kAffine) return affine;
  return glm::perspective(0.8F, 1.5F, 0.5F, 100.0F) * affine;
}

}  // namespace sheaf::experiments
