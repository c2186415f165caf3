#include "scenes/teapot.h"

#include "scenes/builtin_scenes.h"
#include "scenes/shapes.h"

// The control points are Newell's, turned from Z up to Y up. Twenty-four patches are the quarters of six pieces of a
// profile; handle and spout are two pieces each, with a front half and its mirror image.

namespace sheaf::scenes {
namespace {

using Patch = std::array<std::array<DVec3, 4>, 4>;  // [along v][along u]

/// Control point of a quarter circle of radius 1, as Newell chose it (an exact fit would be 0.5523).
constexpr double kArc = 0.56;

/// From the knob over lid, rim and body to the middle of the bottom.
constexpr std::array<ProfilePiece, 6> kProfile = {{
    {{{0.0, 3.15}, {0.8, 3.15}, {0.0, 2.85}, {0.2, 2.7}}},             // knob
    {{{0.2, 2.7}, {0.4, 2.55}, {1.3, 2.55}, {1.3, 2.4}}},              // lid
    {{{1.4, 2.4}, {1.3375, 2.53125}, {1.4375, 2.53125}, {1.5, 2.4}}},  // rim
    {{{1.5, 2.4}, {1.75, 1.875}, {2.0, 1.35}, {2.0, 0.9}}},            // upper body
    {{{2.0, 0.9}, {2.0, 0.45}, {1.5, 0.225}, {1.5, 0.15}}},            // lower body
    {{{1.5, 0.15}, {1.5, 0.075}, {1.425, 0.0}, {0.0, 0.0}}},           // bottom
}};

/// A row of a tube's control points: half a cross section from (x0, y0) over the depth +-z to (x1, y1).
struct TubeRow {
  double x0, y0;
  double x1, y1;
  double depth;
};
using TubePiece = std::array<TubeRow, 4>;

constexpr std::array<TubePiece, 4> kTubes = {{
    // Handle, from the top.
    {{{-1.6, 2.025, -1.5, 2.25, 0.3},
      {-2.3, 2.025, -2.5, 2.25, 0.3},
      {-2.7, 2.025, -3.0, 2.25, 0.3},
      {-2.7, 1.8, -3.0, 1.8, 0.3}}},
    {{{-2.7, 1.8, -3.0, 1.8, 0.3},
      {-2.7, 1.575, -3.0, 1.35, 0.3},
      {-2.5, 1.125, -2.65, 0.9375, 0.3},
      {-2.0, 0.9, -1.9, 0.6, 0.3}}},
    // Spout, from the body.
    {{{1.7, 1.425, 1.7, 0.6, 0.66},
      {2.6, 1.425, 3.1, 0.825, 0.66},
      {2.3, 2.1, 2.4, 2.025, 0.25},
      {2.7, 2.4, 3.3, 2.4, 0.25}}},
    {{{2.7, 2.4, 3.3, 2.4, 0.25},
      {2.8, 2.475, 3.525, 2.49375, 0.25},
      {2.9, 2.475, 3.45, 2.5125, 0.15},
      {2.8, 2.4, 3.2, 2.4, 0.15}}},
}};

/// Quarter `turn` of a piece of the profile; u runs counter-clockwise seen from above.
Patch quarterPatch(const ProfilePiece& piece, int turn) {
  static constexpr std::array<std::array<double, 2>, 4> kQuarter = {{{1.0, 0.0}, {1.0, kArc}, {kArc, 1.0}, {0.0, 1.0}}};
  Patch patch;
  for (std::size_t row = 0; row < 4; ++row)
    for (std::size_t i = 0; i < 4; ++i) {
      std::array<double, 2> at = kQuarter[i];  // along +X and -Z
      for (int k = 0; k < turn; ++k) at = {-at[1], at[0]};
      patch[row][i] = DVec3(piece[row][0] * at[0], piece[row][1], -piece[row][0] * at[1]);
    }
  return patch;
}

Patch tubePatch(const TubePiece& piece, bool front) {
  Patch patch;
  for (std::size_t row = 0; row < 4; ++row) {
    const TubeRow& r = piece[row];
    const double z = front ? r.depth : -r.depth;
    patch[row] = {DVec3(r.x0, r.y0, 0.0), DVec3(r.x0, r.y0, z), DVec3(r.x1, r.y1, z), DVec3(r.x1, r.y1, 0.0)};
    if (front) std::swap(patch[row][0], patch[row][3]), std::swap(patch[row][1], patch[row][2]);
  }
  return patch;
}

struct PatchPoint {
  DVec3 position;
  DVec3 along_u;
  DVec3 along_v;
};

PatchPoint evaluate(const Patch& patch, double u, double v) {
  std::array<DVec3, 4> rows;
  std::array<DVec3, 4> rows_along_u;
  for (std::size_t row = 0; row < 4; ++row) {
    const CurvePoint p = bezier(patch[row], u);
    rows[row] = p.position;
    rows_along_u[row] = p.derivative;
  }
  const CurvePoint across = bezier(rows, v);
  return {across.position, bezier(rows_along_u, v).position, across.derivative};
}

mesh::Mesh tessellate(const Patch& patch, int n) {
  return gridSurface({n, n, false, false}, [&](double u, double v) {
    const PatchPoint p = evaluate(patch, u, v);
    DVec3 normal = glm::cross(p.along_v, p.along_u);
    if (glm::dot(normal, normal) < 1e-12) {
      // At a pole the row shrinks to a point; a little inside the patch it still has a direction.
      const PatchPoint inside = evaluate(patch, u, v < 0.5 ? 1e-4 : 1.0 - 1e-4);
      normal = glm::cross(inside.along_v, inside.along_u);
    }
    return SurfacePoint{p.position, normal};
  });
}

}  // namespace

mesh::Mesh teapotMesh(int n) {
  mesh::Mesh whole;
  for (const ProfilePiece& piece : kProfile)
    for (int turn = 0; turn < 4; ++turn) append(whole, tessellate(quarterPatch(piece, turn), n));
  for (const TubePiece& piece : kTubes)
    for (const bool front : {true, false}) append(whole, tessellate(tubePatch(piece, front), n));
  return whole;
}

Scene buildTeapot(const BuiltinArguments& arguments) {
  Scene scene;
  scene.meshes.push_back(teapotMesh(arguments.whole("n")));
  Material glaze;
  glaze.name = "glaze";
  glaze.base_color = Vec4(0.08F, 0.30F, 0.34F, 1.0F);
  glaze.specular = 0.12F;
  glaze.shininess = 120.0F;
  glaze.double_sided = true;  // between lid and rim one can look inside
  scene.materials.push_back(glaze);
  scene.instances.emplace_back();
  return scene;
}

}  // namespace sheaf::scenes
