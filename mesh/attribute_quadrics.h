// mesh/attribute_quadrics: what contracting edges does to normals, texture coordinates and colours, after [H99]: each
// triangle says how an attribute runs over its plane, and the error of a vertex is how far it is from what its
// triangles say. Internal to mesh/.
#pragma once

#include <span>
#include <vector>

#include "mesh/collapse_mesh.h"
#include "mesh/quadric.h"

namespace sheaf::mesh {

struct AttributeWeights {
  double normal = 0.0, texcoord = 0.0, color = 0.0;
};

/// A wedge is the set of corners at a point that have the same attributes; a point on a seam has several.
class AttributeQuadrics {
 public:
  /// wedges         a mesh whose vertices are the wedges, each different from all others; must outlive this
  /// corner_points  the point of each corner of the same triangles
  /// points         positions in the unit of the error
  AttributeQuadrics(const Mesh& wedges, std::span<const Triangle> corner_points, std::span<const DVec3> points,
                    const AttributeWeights& weights);

  /// True if the triangles on the edge between two points do not agree on the wedges at its ends.
  bool isSeam(CollapseMesh& topology, std::uint32_t a, std::uint32_t b) const;

  /// The error as a function of place alone, if b is merged into a and the attributes are chosen best for each place.
  Quadric mergedError(CollapseMesh& topology, std::uint32_t a, std::uint32_t b);

  /// Merges the wedges of b into those of a. Before CollapseMesh::collapse().
  void collapse(CollapseMesh& topology, std::uint32_t a, std::uint32_t b);

  const Triangle& wedgesOf(std::uint32_t triangle) const { return corner_wedges_[triangle]; }

  /// Writes the best attributes of a wedge for a position: vertex `out` of `mesh`, whose arrays are there.
  void store(std::uint32_t wedge, const DVec3& position, Mesh& mesh, std::size_t out) const;

 private:
  /// Of one attribute: sum over triangles of area * gradient and area * offset.
  struct Linear {
    DVec3 g{0.0};
    double d = 0.0;
  };
  struct Wedge {
    Quadric square;  ///< sum of area * (g.x + d)^2 over triangles and attributes
    double area = 0.0;
    Quadric error;  ///< with the attributes chosen best for each place
  };
  /// A wedge that an edge's contraction merges, and the least wedge that it is merged with.
  struct Merged {
    std::uint32_t wedge;
    std::uint32_t into;
  };

  double weightedValue(std::uint32_t wedge, std::size_t attribute) const;
  void addTriangle(const Triangle& wedges, const Triangle& points, std::span<const DVec3> positions);
  std::uint32_t wedgeAt(const CollapseMesh& topology, std::uint32_t triangle, std::uint32_t point) const;
  void findMerged(CollapseMesh& topology, std::uint32_t a, std::uint32_t b);
  std::uint32_t targetOf(std::uint32_t wedge) const;
  Quadric errorOf(const Quadric& square, std::span<const Linear> linears, double area) const;
  Quadric mergedErrorOf(std::uint32_t into);
  std::span<Linear> linearsOf(std::uint32_t wedge);

  const Mesh& source_;
  std::vector<double> weight_;  // per attribute
  std::vector<Triangle> corner_wedges_;
  std::vector<Wedge> wedges_;
  std::vector<Linear> linears_;  // #attributes per wedge
  std::vector<Quadric> errors_;  // per point: sum over its wedges
  std::vector<Merged> merged_;   // scratch, few
  std::vector<Linear> sums_;     // scratch
  Vec4 color_lo_{0.0F}, color_hi_{0.0F};
};

}  // namespace sheaf::mesh
