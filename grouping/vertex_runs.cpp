#include "grouping/vertex_runs.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <tuple>

namespace sheaf::grouping {
namespace {

constexpr std::size_t kMaxVertices = 256, kMaxTriangles = 512;
// Stretches of at least so many vertices are worth beginning at a cache line.
constexpr std::uint32_t kLongStretch = 64;

std::uint32_t alignedCount(std::uint32_t count) {
  return (count + kRunAlignment - 1) / kRunAlignment * kRunAlignment;
}

// Sorts one patch's vertices and triangles by run.
class PatchSorter {
 public:
  PatchSorter(const PlacedVertices& placed, std::uint32_t min_plane_run, PatchSet& set)
      : placed_(placed), min_plane_run_(min_plane_run), set_(set) {}

  std::vector<VertexRun> sort(const Patch& patch) {
    readPlaces(patch);
    storeShortRunsInFull(patch.vertex_count);
    orderVertices(patch);
    std::vector<VertexRun> runs = makeRuns(patch);
    orderTriangles(patch, runs);
    return runs;
  }

 private:
  static auto keyOf(const VertexPlace& p) { return std::tuple(p.kind, p.axis, p.plane, p.line); }

  void readPlaces(const Patch& patch) {
    for (std::uint32_t i = 0; i < patch.vertex_count; ++i) {
      places_[i] = placed_.places[set_.vertex_source[patch.first_vertex + i]];
      places_[i].s = 0.0F;  // not part of what a run is
    }
    sortLocals(patch.vertex_count);
  }

  void sortLocals(std::uint32_t count) {
    std::iota(order_.begin(), order_.begin() + count, std::uint16_t{0});
    std::stable_sort(order_.begin(), order_.begin() + count,
                     [&](std::uint16_t a, std::uint16_t b) { return keyOf(places_[a]) < keyOf(places_[b]); });
  }

  // Calls body(begin, end) for each run of order_.
  template <typename Body>
  void forRuns(std::uint32_t count, const Body& body) {
    for (std::uint32_t begin = 0, end = 0; begin < count; begin = end) {
      while (end < count && places_[order_[end]].sharesRunWith(places_[order_[begin]])) ++end;
      body(begin, end);
    }
  }

  void storeShortRunsInFull(std::uint32_t count) {
    std::array<std::uint16_t, kMaxVertices> short_ones;
    std::size_t short_count = 0;
    forRuns(count, [&](std::uint32_t begin, std::uint32_t end) {
      const RunKind kind = places_[order_[begin]].kind;
      // Lines stay: transforming a point in full does not round as its line does.
      const bool too_short = kind == RunKind::kPlane ? end - begin < min_plane_run_
                                                     : kind == RunKind::kLine && min_plane_run_ > kMaxVertices;
      for (std::uint32_t i = begin; too_short && i < end; ++i) short_ones[short_count++] = order_[i];
    });
    for (std::size_t i = 0; i < short_count; ++i) places_[short_ones[i]] = {};
    if (short_count > 0) sortLocals(count);
  }

  void orderVertices(const Patch& patch) {
    const auto first = set_.vertex_source.begin() + patch.first_vertex;
    std::array<std::uint32_t, kMaxVertices> source;
    for (std::uint32_t i = 0; i < patch.vertex_count; ++i) {
      source[i] = first[order_[i]];
      renumbered_[order_[i]] = static_cast<std::uint8_t>(i);
    }
    std::copy_n(source.begin(), patch.vertex_count, first);
    std::fill(first + patch.vertex_count, first + alignedCount(patch.vertex_count), source[patch.vertex_count - 1]);
    for (auto& corner : set_.corners)
      for (std::uint32_t t = 0; t < patch.triangle_count; ++t) {
        std::uint8_t& c = corner[patch.first_triangle + t];
        c = renumbered_[c];
      }
  }

  std::vector<VertexRun> makeRuns(const Patch& patch) {
    std::vector<VertexRun> runs;
    forRuns(patch.vertex_count, [&](std::uint32_t begin, std::uint32_t end) {
      const VertexPlace& place = places_[order_[begin]];
      VertexRun run{.kind = place.kind,
                    .axis = place.axis,
                    .vertex_count = static_cast<std::uint16_t>(end - begin),
                    .plane = place.plane,
                    .line = place.line};
      Box3 box;
      float s_min = std::numeric_limits<float>::infinity(), s_max = -s_min;
      for (std::uint32_t i = begin; i < end; ++i) {
        const std::uint32_t v = set_.vertex_source[patch.first_vertex + i];
        box.extend(place.kind == RunKind::kPlane ? placed_.coordinatesOf(v) : placed_.positions[v]);
        s_min = std::min(s_min, placed_.places[v].s);
        s_max = std::max(s_max, placed_.places[v].s);
        run_of_[i] = static_cast<std::uint16_t>(runs.size());
      }
      run.corner_lo = box.lo;
      run.corner_hi = box.hi;
      if (run.kind == RunKind::kLine) {
        const RunLine& line = placed_.lines[run.line];
        run.corner_lo = line.base + s_min * line.direction;
        run.corner_hi = line.base + s_max * line.direction;
      }
      runs.push_back(run);
    });
    return runs;
  }

  void orderTriangles(const Patch& patch, std::vector<VertexRun>& runs) {
    const std::uint32_t first = patch.first_triangle, count = patch.triangle_count;
    std::array<std::uint16_t, kMaxTriangles> key;
    std::vector<std::uint32_t> at(runs.size() + 1, 0);
    for (std::uint32_t t = 0; t < count; ++t) {
      const std::uint16_t a = run_of_[set_.corners[0][first + t]];
      const bool inside = a == run_of_[set_.corners[1][first + t]] && a == run_of_[set_.corners[2][first + t]];
      key[t] = inside ? a : static_cast<std::uint16_t>(runs.size());
      if (inside) ++runs[a].triangle_count;
    }
    for (std::size_t r = 0; r < runs.size(); ++r) at[r + 1] = at[r] + runs[r].triangle_count;
    std::array<std::array<std::uint8_t, kMaxTriangles>, 3> corners;
    std::array<std::uint32_t, kMaxTriangles> source;
    for (std::uint32_t t = 0; t < count; ++t) {
      const std::uint32_t to = at[key[t]]++;
      for (std::size_t k = 0; k < 3; ++k) corners[k][to] = set_.corners[k][first + t];
      source[to] = set_.triangle_source[first + t];
    }
    for (std::size_t k = 0; k < 3; ++k) std::copy_n(corners[k].begin(), count, set_.corners[k].begin() + first);
    std::copy_n(source.begin(), count, set_.triangle_source.begin() + first);
  }

  const PlacedVertices& placed_;
  std::uint32_t min_plane_run_;
  PatchSet& set_;
  std::array<VertexPlace, kMaxVertices> places_;       // by old local number
  std::array<std::uint16_t, kMaxVertices> order_;      // old local number of each new one
  std::array<std::uint8_t, kMaxVertices> renumbered_;  // the other way round
  std::array<std::uint16_t, kMaxVertices> run_of_;     // by new local number
};

constexpr std::size_t kPatchesPerPiece = 64;

// Calls body(patch) for all patches, in parallel.
template <typename Body>
void forPatches(std::size_t count, TaskPool& pool, const Body& body) {
  pool.parallelFor(static_cast<int>((count + kPatchesPerPiece - 1) / kPatchesPerPiece), [&](int piece, int) {
    const std::size_t begin = static_cast<std::size_t>(piece) * kPatchesPerPiece;
    for (std::size_t p = begin; p < std::min(count, begin + kPatchesPerPiece); ++p) body(p);
  });
}

// Copies the vertices of one patch into the arrays; firsts are set.
class PatchFiller {
 public:
  PatchFiller(const PlacedVertices& placed, const Patch& patch, const PatchSet& set, VertexRuns& out)
      : placed_(placed), source_(set.vertex_source.data() + patch.first_vertex), out_(out) {}

  void fill(PatchRuns& at, std::uint32_t vertex_count) {
    if (out_.form == ParameterForm::k16Bit) findCorner(at, vertex_count);
    corner_ = at.corner;
    full_ = at.first_full;
    parameter_ = at.first_parameter;
    const std::uint32_t* next = source_;
    for (std::uint32_t r = at.first_run; r < at.first_run + at.run_count; ++r) {
      const VertexRun& run = out_.runs[r];
      for (std::uint32_t i = 0; i < run.vertex_count; ++i) {
        if (run.kind == RunKind::kFull)
          storeFull(*next++);
        else if (run.kind == RunKind::kPlane)
          storeOnPlane(*next++, run.axis);
        else
          storeOnLine(*next++, placed_.lines[run.line]);
      }
    }
  }

 private:
  std::int32_t gridNumber(std::uint32_t v, std::size_t k) const {
    return static_cast<std::int32_t>(placed_.coordinatesOf(v)[static_cast<int>(k)] / out_.step);
  }

  void findCorner(PatchRuns& at, std::uint32_t vertex_count) const {
    at.corner.fill(std::numeric_limits<std::int32_t>::max());
    for (std::uint32_t i = 0; i < vertex_count; ++i) {
      const VertexPlace& place = placed_.places[source_[i]];
      for (std::size_t k = 0; k < 3; ++k)
        if (place.kind == RunKind::kPlane && k != place.axis)
          at.corner[k] = std::min(at.corner[k], gridNumber(source_[i], k));
    }
  }

  void storeFull(std::uint32_t v) {
    for (std::size_t k = 0; k < 3; ++k)
      out_.full[full_ + k * out_.full_stride] = placed_.positions[v][static_cast<int>(k)];
    ++full_;
  }

  void storeOnPlane(std::uint32_t v, std::size_t axis) {
    const auto [i, j] = axesBeside(axis);
    const Vec3& p = placed_.coordinatesOf(v);
    if (out_.form == ParameterForm::kFloat)
      out_.parameters[parameter_] = {p[static_cast<int>(i)], p[static_cast<int>(j)]};
    else
      out_.quantised[parameter_] = static_cast<std::uint32_t>(gridNumber(v, i) - corner_[i]) |
                                   static_cast<std::uint32_t>(gridNumber(v, j) - corner_[j]) << 16;
    ++parameter_;
  }

  void storeOnLine(std::uint32_t v, const RunLine& line) {
    const float s = placed_.places[v].s;
    if (out_.form == ParameterForm::kFloat)
      out_.parameters[parameter_] = {s, 0.0F};
    else if (line.ds > 0.0F)
      out_.quantised[parameter_] = static_cast<std::uint32_t>(std::nearbyint((s - line.s0) / line.ds));
    ++parameter_;
  }

  const PlacedVertices& placed_;
  const std::uint32_t* source_;
  VertexRuns& out_;
  std::array<std::int32_t, 3> corner_{};
  std::size_t full_ = 0, parameter_ = 0;
};

// x, y, z of every slot, padding included.
void fillBySlot(std::span<const Vec3> positions, const PatchSet& set, TaskPool& pool, VertexRuns& out) {
  out.full_stride = set.vertex_source.size();  // a multiple of kRunAlignment
  out.full.resize(3 * out.full_stride + kRunAlignment);
  forPatches(set.patches.size(), pool, [&](std::size_t p) {
    const std::uint32_t begin = set.patches[p].first_vertex;
    out.patches[p].first_full = begin;
    const std::uint32_t end = begin + alignedCount(set.patches[p].vertex_count);
    for (std::uint32_t slot = begin; slot < end; ++slot)
      for (std::size_t k = 0; k < 3; ++k)
        out.full[slot + k * out.full_stride] = positions[set.vertex_source[slot]][static_cast<int>(k)];
  });
}

// Lays the patches' runs end to end. Returns whether all vertices are stored in full.
bool joinRuns(const std::vector<std::vector<VertexRun>>& runs, VertexRuns& out) {
  std::uint32_t full = 0, parameters = 0;
  out.patches.resize(runs.size());
  for (std::size_t p = 0; p < runs.size(); ++p) {
    std::uint32_t full_here = 0, parameters_here = 0;
    for (const VertexRun& run : runs[p]) (run.kind == RunKind::kFull ? full_here : parameters_here) += run.vertex_count;
    if (full_here >= kLongStretch) full = alignedCount(full);
    if (parameters_here >= kLongStretch) parameters = alignedCount(parameters);
    PatchRuns& at = out.patches[p];
    at.first_run = static_cast<std::uint32_t>(out.runs.size());
    at.run_count = static_cast<std::uint32_t>(runs[p].size());
    at.first_full = full;
    at.first_parameter = parameters;
    full += full_here;
    parameters += parameters_here;
    out.runs.insert(out.runs.end(), runs[p].begin(), runs[p].end());
  }
  if (parameters == 0) return true;
  out.full_stride = alignedCount(full);
  out.full.resize(3 * out.full_stride + kRunAlignment);
  if (out.form == ParameterForm::k16Bit)
    out.quantised.resize(std::size_t{parameters} + kRunAlignment);
  else
    out.parameters.resize(std::size_t{parameters} + kRunAlignment);
  return false;
}

// Those of patches that have planes.
void keepFrames(const PlacedVertices& placed, VertexRuns& out) {
  for (std::size_t p = 0; p < placed.frames.size(); ++p) {
    PatchRuns& at = out.patches[p];
    const auto runs = std::span(out.runs).subspan(at.first_run, at.run_count);
    if (std::none_of(runs.begin(), runs.end(), [](const VertexRun& r) { return r.kind == RunKind::kPlane; })) continue;
    at.frame = static_cast<std::uint32_t>(out.frames.size());
    out.frames.push_back(placed.frames[p]);
  }
}

std::uint64_t bytesOf(const auto& v) {
  return v.size() * sizeof(v[0]);
}

}  // namespace

std::uint64_t VertexRuns::bytes() const {
  std::uint64_t sum = bytesOf(patches) + bytesOf(runs) + bytesOf(lines) + bytesOf(frames);
  return sum + bytesOf(full) + bytesOf(quantised) + bytesOf(parameters);
}

VertexRuns ungroupedRuns(const mesh::Mesh& mesh, const PatchSet& patches, TaskPool& pool) {
  VertexRuns out;
  for (const Patch& patch : patches.patches) {
    out.patches.push_back({.first_run = static_cast<std::uint32_t>(out.runs.size()), .run_count = 1});
    out.runs.push_back({.vertex_count = static_cast<std::uint16_t>(patch.vertex_count),
                        .triangle_count = static_cast<std::uint16_t>(patch.triangle_count),
                        .corner_lo = patch.bounds.lo,
                        .corner_hi = patch.bounds.hi});
  }
  fillBySlot(mesh.positions, patches, pool, out);
  return out;
}

VertexRuns buildVertexRuns(const PlacedVertices& placed, std::uint32_t min_plane_run, PatchSet& patches,
                           TaskPool& pool) {
  VertexRuns out;
  out.form = placed.form;
  out.step = placed.step;
  out.lines = placed.lines;
  std::vector<std::vector<VertexRun>> runs(patches.patches.size());
  forPatches(runs.size(), pool,
             [&](std::size_t p) { runs[p] = PatchSorter(placed, min_plane_run, patches).sort(patches.patches[p]); });
  if (joinRuns(runs, out)) {
    fillBySlot(placed.positions, patches, pool, out);
    return out;
  }
  keepFrames(placed, out);
  forPatches(runs.size(), pool, [&](std::size_t p) {
    PatchFiller(placed, patches.patches[p], patches, out).fill(out.patches[p], patches.patches[p].vertex_count);
  });
  return out;
}

}  // namespace sheaf::grouping
