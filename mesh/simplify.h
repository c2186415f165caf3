// mesh/simplify: fewer triangles for nearly the same surface, by contracting edges in the order of their quadric error
// [GH97], with attributes after [H99]. Keys: docs/references.md.
#pragma once

#include <cstddef>

#include "mesh/mesh.h"

namespace sheaf::mesh {

struct SimplifyOptions {
  /// Stop when at most so many distinct positions are left. With attributes the result may have more vertices than
  /// that, because a position on a seam is one vertex per side.
  std::size_t target_vertices = 0;
  /// Stop when at most so many triangles are left. Whichever target is met first counts; at least one must not be 0.
  std::size_t target_triangles = 0;
  /// Weight of the planes that hold borders, edges of three or more triangles and seams in place [GH97 §6].
  double border_weight = 1000.0;
  /// Carry normals, texture coordinates and colours over and let them count in the error. Otherwise the result has
  /// positions only, and seams do not hinder.
  bool attributes = false;
  /// What a difference of 1 in an attribute counts, against a distance of the longest edge of the mesh's box.
  double normal_weight = 0.05;
  double texcoord_weight = 0.2;
  double color_weight = 0.1;
};

enum class SimplifyStop {
  kTargetReached,
  kTopology,  ///< every edge left would change the topology or fold the surface over
};

struct SimplifyResult {
  Mesh mesh;  ///< without unused vertices, without triangles that use a position twice; the input's order is kept
  SimplifyStop stop = SimplifyStop::kTargetReached;
  std::size_t positions = 0;          ///< distinct positions in `mesh`
  std::size_t dropped_triangles = 0;  ///< unusable ones of the input: not finite, a position twice, or a repetition
};

/// Vertices at exactly the same place are one to begin with. A contraction is refused if it would change the topology
/// (link condition; borders stay borders), turn a triangle by more than about 78 degrees, or leave two equal triangles.
/// So a closed manifold keeps its Euler characteristic. Deterministic: equal costs go to the lower index.
SimplifyResult simplify(const Mesh& mesh, const SimplifyOptions& options);

}  // namespace sheaf::mesh
