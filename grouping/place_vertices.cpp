// Where each vertex of a grouped mesh is drawn.
#include <algorithm>
#include <cassert>
#include <cmath>

#include "grouping/vertex_runs.h"

namespace sheaf::grouping {
namespace {

// 16-bit numbers, less two for the rounding of the two ends.
constexpr double kGridSteps = 65533.0;

// Planes through defining vertices, by axis, ascending.
std::array<std::vector<float>, 3> planesOf(const VertexGroups& groups) {
  std::array<std::vector<float>, 3> planes;
  for (std::size_t v = 0; v < groups.state.size(); ++v) {
    if (groups.state[v] != VertexState::kDefining) continue;
    for (int k = 0; k < 3; ++k) planes[static_cast<std::size_t>(k)].push_back(groups.positions[v][k]);
  }
  for (std::vector<float>& axis : planes) {
    std::sort(axis.begin(), axis.end());
    axis.erase(std::unique(axis.begin(), axis.end()), axis.end());
  }
  return planes;
}

// Indices [begin, end) of the planes of one axis that may take a vertex.
struct Reach {
  std::uint32_t begin = 0, end = 0;
};

// Chooses planes patch by patch: again and again the one that has most vertices, counting those that an earlier patch
// has put there.
class PlaneChooser {
 public:
  PlaneChooser(const mesh::Mesh& mesh, const VertexGroups& groups, PlacedVertices& placed)
      : mesh_(mesh), groups_(groups), placed_(placed), planes_(planesOf(groups)) {}

  void choose(std::span<const std::uint32_t> vertices) {
    open_.clear();
    for (auto& counts : counts_) counts.clear();
    for (const std::uint32_t v : vertices) {
      const VertexPlace& place = placed_.places[v];
      if (place.kind == RunKind::kPlane) continue;
      if (groups_.state[v] != VertexState::kGrouped && groups_.state[v] != VertexState::kDefining) continue;
      const std::array<Reach, 3> reach = reachOf(v);
      const bool reached = std::any_of(reach.begin(), reach.end(), [](const Reach& r) { return r.begin < r.end; });
      if (reached)
        open_.push_back({v, reach});
      else  // the search rounds epsilon in its own way
        putOnGroup(v);
    }
    if (open_.empty()) return;
    countOpen(vertices);
    while (!open_.empty()) takeBest();
  }

 private:
  struct Open {
    std::uint32_t vertex;
    std::array<Reach, 3> reach;
  };

  std::array<Reach, 3> reachOf(std::uint32_t v) const {
    std::array<Reach, 3> reach;
    const double eps = groups_.state[v] == VertexState::kDefining ? 0.0 : groups_.epsilon * groups_.extent;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::vector<float>& planes = planes_[k];
      const double x = mesh_.positions[v][static_cast<int>(k)];
      const auto near = [&](float plane) { return std::abs(plane - x) <= eps; };
      auto first = std::lower_bound(planes.begin(), planes.end(), x - eps);
      while (first != planes.begin() && near(*(first - 1))) --first;  // the bound may have rounded past one
      while (first != planes.end() && *first < x && !near(*first)) ++first;
      auto last = first;
      while (last != planes.end() && near(*last)) ++last;
      reach[k] = {static_cast<std::uint32_t>(first - planes.begin()),
                  static_cast<std::uint32_t>(last - planes.begin())};
    }
    return reach;
  }

  void countOpen(std::span<const std::uint32_t> vertices) {
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t begin = kNoIndex, end = 0;
      for (const Open& o : open_) {
        if (o.reach[k].begin == o.reach[k].end) continue;
        begin = std::min(begin, o.reach[k].begin);
        end = std::max(end, o.reach[k].end);
      }
      first_[k] = begin;
      if (begin < end) counts_[k].assign(end - begin, 0);
    }
    for (const Open& o : open_) addTo(o, 1);
    for (const std::uint32_t v : vertices) {
      const VertexPlace& place = placed_.places[v];
      if (place.kind != RunKind::kPlane) continue;
      const std::vector<float>& planes = planes_[place.axis];
      const auto at =
          static_cast<std::uint32_t>(std::lower_bound(planes.begin(), planes.end(), place.plane) - planes.begin());
      if (at - first_[place.axis] < counts_[place.axis].size()) ++counts_[place.axis][at - first_[place.axis]];
    }
  }

  void addTo(const Open& o, int amount) {
    for (std::size_t k = 0; k < 3; ++k)
      for (std::uint32_t p = o.reach[k].begin; p < o.reach[k].end; ++p) counts_[k][p - first_[k]] += amount;
  }

  void takeBest() {
    std::size_t axis = 0;
    std::uint32_t best = 0;
    int most = -1;
    for (std::size_t k = 0; k < 3; ++k)
      for (std::uint32_t p = 0; p < counts_[k].size(); ++p)
        if (counts_[k][p] > most) most = counts_[k][p], axis = k, best = p;
    const std::uint32_t plane = first_[axis] + best;
    std::size_t left = 0;
    for (const Open& o : open_) {
      if (plane < o.reach[axis].begin || plane >= o.reach[axis].end) {
        open_[left++] = o;
        continue;
      }
      addTo(o, -1);
      put(o.vertex, axis, planes_[axis][plane]);
    }
    // Nobody is left for it, so that each turn makes progress.
    open_.resize(left);
    counts_[axis][best] = -1;
  }

  void putOnGroup(std::uint32_t v) {
    const VertexGroup& group = groups_.groups[groups_.owner[v]];
    put(v, group.plane, group.base[static_cast<int>(group.plane)]);
  }

  void put(std::uint32_t v, std::size_t axis, float plane) {
    placed_.places[v].kind = RunKind::kPlane;
    placed_.places[v].axis = static_cast<std::uint8_t>(axis);
    placed_.places[v].plane = plane;
    placed_.positions[v] = mesh_.positions[v];
    placed_.positions[v][static_cast<int>(axis)] = plane;
  }

  const mesh::Mesh& mesh_;
  const VertexGroups& groups_;
  PlacedVertices& placed_;
  std::array<std::vector<float>, 3> planes_;
  std::vector<Open> open_;
  std::array<std::vector<int>, 3> counts_;
  std::array<std::uint32_t, 3> first_{};
};

void putOnGroups(const VertexGroups& groups, PlacedVertices& placed) {
  for (const VertexGroup& g : groups.groups) {
    VertexPlace place;
    if (g.kind == GroupKind::kPlane) {
      place.kind = RunKind::kPlane;
      place.axis = static_cast<std::uint8_t>(g.plane);
      place.plane = g.base[static_cast<int>(g.plane)];
    } else {
      place.kind = RunKind::kLine;
      place.line = static_cast<std::uint32_t>(placed.lines.size());
      placed.lines.push_back({g.base, g.axis_s, g.s_min, (g.s_max - g.s_min) / 65535.0F});
    }
    for (std::uint32_t m = g.first_member; m < g.first_member + g.member_count; ++m) {
      place.s = groups.s[m];
      placed.places[groups.members[m]] = place;
      if (place.kind == RunKind::kPlane) placed.positions[groups.members[m]][place.axis] = place.plane;
    }
    if (g.kind == GroupKind::kPlane && g.origin != kNoIndex) placed.places[g.origin] = place;
  }
}

Vec3 pointIn(const PatchFrame& frame, const Vec3& p) {
  return Vec3(DVec3(frame.origin) + double{p.x} * DVec3(frame.axes.axis_s) + double{p.y} * DVec3(frame.axes.axis_t) +
              double{p.z} * DVec3(frame.axes.normal));
}

// The frame of each patch has its origin on its first plane, near its vertices whatever the mesh's own origin.
void placeInFrame(const VertexGroup& g, std::span<const std::uint32_t> members, const VertexGroups& groups,
                  const PatchFrame& frame, PlacedVertices& placed) {
  const auto inFrame = [&](const Vec3& p) {
    const DVec3 d = DVec3(p) - DVec3(frame.origin);
    return Vec3(glm::dot(d, DVec3(frame.axes.axis_s)), glm::dot(d, DVec3(frame.axes.axis_t)),
                glm::dot(d, DVec3(frame.axes.normal)));
  };
  VertexPlace place;
  place.kind = RunKind::kPlane;
  place.axis = 2;
  place.plane = inFrame(g.base).z;
  for (const std::uint32_t v : members) {
    placed.places[v] = place;
    placed.in_frame[v] = inFrame(groups.positions[v]);
    placed.in_frame[v].z = place.plane;
  }
}

// Of planes: the power of two at which every patch fits 16 bits and every coordinate 24.
float gridStep(const PlacedVertices& placed, const PatchSet& set) {
  double size = 0.0, farthest = 0.0;
  for (const Patch& patch : set.patches) {
    Box3 box;
    for (const std::uint32_t v : set.verticesOf(patch))
      if (placed.places[v].kind == RunKind::kPlane) box.extend(placed.coordinatesOf(v));
    if (box.empty()) continue;
    size = std::max(size, double{box.longestEdge()});
    for (int k = 0; k < 3; ++k)
      farthest = std::max({farthest, std::abs(double{box.lo[k]}), std::abs(double{box.hi[k]})});
  }
  const double least = std::max({size / kGridSteps, farthest / (1 << 23), 1e-30});
  return static_cast<float>(std::exp2(std::ceil(std::log2(least))));
}

void quantise(const PatchSet& set, PlacedVertices& placed) {
  placed.step = gridStep(placed, set);
  for (std::size_t v = 0; v < placed.places.size(); ++v) {
    VertexPlace& place = placed.places[v];
    if (place.kind == RunKind::kPlane) {
      Vec3& p = placed.frames.empty() ? placed.positions[v] : placed.in_frame[v];
      for (int k = 0; k < 3; ++k)
        if (k != place.axis) p[k] = static_cast<float>(std::nearbyint(double{p[k]} / placed.step)) * placed.step;
    } else if (place.kind == RunKind::kLine) {
      const RunLine& line = placed.lines[place.line];
      const float q = line.ds > 0.0F ? std::nearbyint((place.s - line.s0) / line.ds) : 0.0F;
      place.s = line.s0 + std::clamp(q, 0.0F, 65535.0F) * line.ds;
      placed.positions[v] = line.base + place.s * line.direction;
    }
  }
}

}  // namespace

PlacedVertices placeGrouped(const mesh::Mesh& mesh, const VertexGroups& groups, const PatchSet& patches,
                            ParameterForm form) {
  assert(groups.positions.size() == mesh.vertexCount());
  if (groups.kind != GroupKind::kPlane || groups.metric != Metric::kDistance)
    return placeOnGroups(groups, patches, form);
  PlacedVertices placed;
  placed.positions = groups.positions;
  placed.places.resize(mesh.vertexCount());
  placed.form = form;
  PlaneChooser chooser(mesh, groups, placed);
  for (const Patch& patch : patches.patches) chooser.choose(patches.verticesOf(patch));
  if (form == ParameterForm::k16Bit) quantise(patches, placed);
  return placed;
}

PlacedVertices placeOnGroups(const VertexGroups& groups, const PatchSet& patches, ParameterForm form) {
  PlacedVertices placed;
  placed.positions = groups.positions;
  placed.places.resize(groups.positions.size());
  placed.form = form;
  putOnGroups(groups, placed);
  if (form == ParameterForm::k16Bit) quantise(patches, placed);
  return placed;
}

PlacedVertices placeInFrames(const mesh::Mesh& mesh, const VertexGroups& groups, const PatchSet& patches,
                             ParameterForm form) {
  assert(groups.positions.size() == mesh.vertexCount() && groups.planes.size() == patches.patches.size());
  PlacedVertices placed;
  placed.positions = groups.positions;
  placed.places.resize(mesh.vertexCount());
  placed.in_frame.resize(mesh.vertexCount());
  placed.frames.resize(patches.patches.size());
  placed.form = form;
  std::vector<std::uint32_t> patch_of(mesh.vertexCount(), kNoIndex);  // of members
  std::uint32_t last = kNoIndex;
  for (const VertexGroup& g : groups.groups) {
    PatchFrame& frame = placed.frames[g.plane];
    if (g.plane != last) frame = {g.base, groups.planes[g.plane]};
    last = g.plane;
    const auto members = std::span(groups.members).subspan(g.first_member, g.member_count);
    placeInFrame(g, members, groups, frame, placed);
    for (const std::uint32_t v : members) patch_of[v] = g.plane;
  }
  if (form == ParameterForm::k16Bit) quantise(patches, placed);
  for (std::size_t v = 0; v < patch_of.size(); ++v)
    if (patch_of[v] != kNoIndex) placed.positions[v] = pointIn(placed.frames[patch_of[v]], placed.in_frame[v]);
  return placed;
}

}  // namespace sheaf::grouping
