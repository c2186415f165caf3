// scenes/shapes: meshes of simple solids for generated scenes.
//   Keeps  counter-clockwise seen from outside; unit normals; texture coordinates unless said otherwise; positions
//          shared by two patches or by both ends of a closed grid are equal to the bit, so that welding closes the
//          shape; no triangle with two equal corners
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "core/math.h"
#include "mesh/mesh.h"

namespace sheaf::scenes {

struct SurfacePoint {
  DVec3 position;
  DVec3 normal;  ///< outwards, any length above 0
};

/// How a grid over the unit square closes: the last column (row) repeats the first.
struct GridShape {
  int columns = 1;  ///< quads along u
  int rows = 1;     ///< quads along v
  bool closed_u = false;
  bool closed_v = false;
};

/// A surface over (u, v) in [0, 1]^2; seen from outside u grows to the right and v downwards, as on a picture. Texture
/// coordinates are (u, v).
mesh::Mesh gridSurface(const GridShape& shape, const std::function<SurfacePoint(double u, double v)>& surface);

/// One piece of a profile in the half plane (radius, height): a cubic Bezier curve. Pieces run from the top of the
/// outside downwards, so that outside is on their left. Where two pieces meet at an angle the edge stays sharp.
using ProfilePiece = std::array<std::array<double, 2>, 4>;

/// The straight piece from (r0, y0) to (r1, y1).
ProfilePiece straightPiece(double r0, double y0, double r1, double y1);

/// Turns a profile about +Y. v runs from 0 to 1 along the whole profile, u once around. rows: quads along each piece.
mesh::Mesh revolve(std::span<const ProfilePiece> profile, int columns, int rows);

/// Axis-aligned box; each face carries the whole unit square of texture.
mesh::Mesh boxMesh(const DVec3& lo, const DVec3& hi);

/// Upright cylinder-like slab from a polygon: counter-clockwise seen from above, convex. Flat faces.
mesh::Mesh prismMesh(std::span<const std::array<double, 2>> footprint_xz, double bottom, double top);

/// Sphere of radius 1 about the origin without a pole: a cube blown up, `n` quads along each edge of it. No texture
/// coordinates; every vertex is shared. 12 n^2 triangles, 6 n^2 + 2 vertices.
mesh::Mesh cubeSphere(int n);

/// Sphere of radius 1 with longitude as u and colatitude as v (a map of the world fits); `rows` quads from pole to
/// pole.
mesh::Mesh globeMesh(int columns, int rows);

struct TorusKnot {
  int turns_about_axis = 2;
  int turns_through_hole = 3;
  double major_radius = 2.0;
  double minor_radius = 0.8;
  double tube_radius = 0.28;
};

/// Tube along a torus knot about +Y; u along the tube, v around it.
mesh::Mesh torusKnotMesh(const TorusKnot& knot, int columns, int rows);

/// Adds the vertices and triangles of `part` to `whole`. Both have the same attributes, or `whole` is empty.
void append(mesh::Mesh& whole, const mesh::Mesh& part);

/// Point on a cubic Bezier curve and its derivative by t.
struct CurvePoint {
  DVec3 position;
  DVec3 derivative;
};
CurvePoint bezier(const std::array<DVec3, 4>& points, double t);

}  // namespace sheaf::scenes
