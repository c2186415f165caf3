// pipeline/counters: how much work a frame was. Beside every time stands what was done in it.
#pragma once

#include <array>
#include <cstdint>
#include <utility>

namespace sheaf::pipeline {

struct Counters {
  std::uint64_t instances = 0;
  std::uint64_t patches = 0;                ///< patches of all instances
  std::uint64_t patches_outside = 0;        ///< rejected by the view volume
  std::uint64_t patches_back_facing = 0;    ///< rejected by the normal cone
  std::uint64_t boxes_tested = 0;           ///< against the view volume: of patches and of runs of patches
  std::uint64_t vertices_transformed = 0;   ///< in any way; of these
  std::uint64_t vertices_full = 0;          ///< from three coordinates
  std::uint64_t vertices_grouped = 0;       ///< from the parameters of a line or plane
  std::uint64_t vertices_coded = 0;         ///< given outcodes one by one
  std::uint64_t groups_tested = 0;          ///< runs of vertices tested against the view as a whole; of these
  std::uint64_t groups_outside = 0;         ///< rejected
  std::uint64_t groups_inside = 0;          ///< accepted: no member needs clipping
  std::uint64_t triangles_in = 0;           ///< triangles of all instances
  std::uint64_t triangles_assembled = 0;    ///< of patches that were not culled
  std::uint64_t triangles_outside = 0;      ///< all corners beyond one plane
  std::uint64_t triangles_clipped = 0;      ///< cut by the near or far plane or the guard band
  std::uint64_t triangles_back_facing = 0;  ///< seen from behind, or without area
  std::uint64_t triangles_no_sample = 0;    ///< cover no pixel centre
  std::uint64_t triangles_binned = 0;       ///< pieces of clipped ones count singly
  std::uint64_t bin_entries = 0;            ///< over all tiles
  std::uint64_t tiles = 0;
  std::uint64_t tiles_empty = 0;
  std::uint64_t pixels_shaded = 0;
  std::uint64_t pixels_background = 0;

  Counters& operator+=(const Counters& other);
};

/// Every counter under the name that reports give it.
inline constexpr std::array<std::pair<const char*, std::uint64_t Counters::*>, 24> kCounterNames = {{
    {"instances", &Counters::instances},
    {"patches", &Counters::patches},
    {"patches_outside", &Counters::patches_outside},
    {"patches_back_facing", &Counters::patches_back_facing},
    {"boxes_tested", &Counters::boxes_tested},
    {"vertices_transformed", &Counters::vertices_transformed},
    {"vertices_full", &Counters::vertices_full},
    {"vertices_grouped", &Counters::vertices_grouped},
    {"vertices_coded", &Counters::vertices_coded},
    {"groups_tested", &Counters::groups_tested},
    {"groups_outside", &Counters::groups_outside},
    {"groups_inside", &Counters::groups_inside},
    {"triangles_in", &Counters::triangles_in},
    {"triangles_assembled", &Counters::triangles_assembled},
    {"triangles_outside", &Counters::triangles_outside},
    {"triangles_clipped", &Counters::triangles_clipped},
    {"triangles_back_facing", &Counters::triangles_back_facing},
    {"triangles_no_sample", &Counters::triangles_no_sample},
    {"triangles_binned", &Counters::triangles_binned},
    {"bin_entries", &Counters::bin_entries},
    {"tiles", &Counters::tiles},
    {"tiles_empty", &Counters::tiles_empty},
    {"pixels_shaded", &Counters::pixels_shaded},
    {"pixels_background", &Counters::pixels_background},
}};

}  // namespace sheaf::pipeline
