// grouping/patch_cut: what lies between cutting a mesh and writing the patches: triangles in order, and the runs of
// them that are to be patches.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/task_pool.h"
#include "grouping/patches.h"
#include "mesh/mesh.h"

namespace sheaf::grouping {

/// Triangles [begin, end) of PatchCut::triangles. Within PatchLimits.
struct PatchRun {
  std::size_t begin = 0;
  std::size_t end = 0;
  std::uint32_t vertex_count = 0;  ///< different ones

  std::size_t size() const { return end - begin; }
};

struct PatchCut {
  std::vector<std::uint32_t> triangles;  ///< of the mesh, each at most once
  std::vector<PatchRun> runs;            ///< ascending, side by side; together all of `triangles`
};

/// Such triangles are drawn by nobody and stand in no patch.
inline bool usesVertexTwice(const mesh::Triangle& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/// The triangle's normal in double precision, zero if it has no area.
DVec3 unitNormalOf(const mesh::Mesh& mesh, const mesh::Triangle& t);

PatchSet writePatches(const mesh::Mesh& mesh, const PatchCut& cut, TaskPool& pool);

/// Numbers the distinct vertices of one piece in order of first use: no more than the most that a patch may have, and
/// three beyond. Open addressing, never more than half full.
class LocalVertices {
 public:
  LocalVertices() : slots_(kSlots) {}

  /// Begins a new piece.
  void clear() {
    if (++piece_ == 0) {
      std::fill(slots_.begin(), slots_.end(), Slot{});
      piece_ = 1;
    }
    count_ = 0;
  }

  std::uint32_t count() const { return count_; }

  bool has(std::uint32_t vertex) const { return slots_[slotOf(vertex)].piece == piece_; }

  std::uint32_t numberOf(std::uint32_t vertex) {
    Slot& slot = slots_[slotOf(vertex)];
    if (slot.piece != piece_) slot = {piece_, vertex, count_++};
    return slot.number;
  }

 private:
  struct Slot {
    std::uint32_t piece = 0, vertex = 0, number = 0;
  };
  static constexpr int kSlotBits = 10;
  static constexpr std::uint32_t kSlots = 1U << kSlotBits;
  static_assert(kSlots >= 2 * (256 + 3));

  // Where the vertex is, or where it would be put.
  std::uint32_t slotOf(std::uint32_t vertex) const {
    std::uint32_t at = (vertex * 0x9E3779B1U) >> (32 - kSlotBits);
    while (slots_[at].piece == piece_ && slots_[at].vertex != vertex) at = (at + 1) & (kSlots - 1);
    return at;
  }

  std::vector<Slot> slots_;
  std::uint32_t piece_ = 0;
  std::uint32_t count_ = 0;
};

}  // namespace sheaf::grouping
