#include "pipeline/counters.h"

namespace sheaf::pipeline {

Counters& Counters::operator+=(const Counters& other) {
  instances += other.instances;
  patches += other.patches;
  patches_outside += other.patches_outside;
  patches_back_facing += other.patches_back_facing;
  vertices_transformed += other.vertices_transformed;
  vertices_full += other.vertices_full;
  vertices_grouped += other.vertices_grouped;
  vertices_coded += other.vertices_coded;
  groups_tested += other.groups_tested;
  groups_outside += other.groups_outside;
  groups_inside += other.groups_inside;
  triangles_in += other.triangles_in;
  triangles_assembled += other.triangles_assembled;
  triangles_outside += other.triangles_outside;
  triangles_clipped += other.triangles_clipped;
  triangles_back_facing += other.triangles_back_facing;
  triangles_no_sample += other.triangles_no_sample;
  triangles_binned += other.triangles_binned;
  bin_entries += other.bin_entries;
  tiles += other.tiles;
  tiles_empty += other.tiles_empty;
  pixels_shaded += other.pixels_shaded;
  pixels_background += other.pixels_background;
  return *this;
}

}  // namespace sheaf::pipeline
