// mesh/normals: shading normals from geometry. A triangle without area or with a non-finite corner contributes nothing;
// a vertex without any usable triangle gets (0, 1, 0). No normal is ever NaN.
#pragma once

#include "mesh/mesh.h"

namespace sheaf::mesh {

/// Replaces the normals by means of the triangles' normals, weighted by the angle of the corner [TW98].
/// mesh              vertices are told apart by index: weld first where equal positions should share a normal. A vertex
///                   whose triangles fall apart at creases is split: the part with the lowest triangle stays where it
///                   is, the others are appended, with all attributes
/// crease_angle_rad  two triangles on an edge are smoothed over it unless their normals differ by more than this; at
///                   pi or more nothing is split. On an edge of three or more triangles each is compared with the next
/// Time is linear (n log n in the valence of creased vertices). Beside the normals: 4 bytes per vertex and 20 bytes per
/// corner, of vertices near a crease only.
void makeSmoothNormals(Mesh& mesh, double crease_angle_rad);

/// Replaces the normals by the triangles' own: corner k of triangle f becomes vertex 3 f + k.
void makeFlatNormals(Mesh& mesh);

}  // namespace sheaf::mesh
