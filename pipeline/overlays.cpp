#include "pipeline/overlays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

namespace sheaf::pipeline {
namespace {

constexpr float kDark = 0.01F;
constexpr double kWidthPx = 1.6;        ///< of a bar
constexpr double kLargestWidth = 0.03;  ///< the same, of the diagonal of what it outlines
constexpr int kLatticeCells = 4;        ///< per side of a plane

/// A place and three axes in the world, which need neither be long nor at right angles.
struct Frame {
  DVec3 origin{0.0};
  DMat3 axes{1.0};

  DVec3 at(const DVec3& local) const { return origin + axes * local; }
};

Frame operator*(const DMat4& world_from_object, const Frame& frame) {
  return {DVec3(world_from_object * DVec4(frame.origin, 1.0)), DMat3(world_from_object) * frame.axes};
}

/// How wide things are where the picture shows them a pixel wide.
class PixelSize {
 public:
  explicit PixelSize(const OverlayView& view)
      : camera_(view.camera),
        forward_(glm::normalize(view.camera.target - view.camera.eye)),
        is_parallel_(view.camera.orthographic_height > 0.0),
        at_unit_depth_(
            (is_parallel_ ? view.camera.orthographic_height : 2.0 * std::tan(0.5 * view.camera.vertical_fov_rad)) /
            view.height_px) {}

  double at(const DVec3& p) const { return is_parallel_ ? at_unit_depth_ : at_unit_depth_ * depthOf(p); }
  DVec3 toEye(const DVec3& p) const { return is_parallel_ ? -forward_ : camera_.eye - p; }

  /// Moves the ends of a segment to where it is not nearer than the near plane. False if nothing is left.
  bool clip(DVec3& a, DVec3& b) const {
    const double depth_a = depthOf(a) - camera_.near, depth_b = depthOf(b) - camera_.near;
    if (depth_a < 0.0 && depth_b < 0.0) return false;
    const DVec3 between = a + (b - a) * (depth_a / (depth_a - depth_b));  // used only if one of them is negative
    if (depth_a < 0.0) a = between;
    if (depth_b < 0.0) b = between;
    return true;
  }

 private:
  double depthOf(const DVec3& p) const { return glm::dot(p - camera_.eye, forward_); }

  const scenes::Camera& camera_;
  DVec3 forward_;
  bool is_parallel_;
  double at_unit_depth_;
};

DVec3 unitAcross(const DVec3& a, const DVec3& b) {
  const DVec3 across = glm::cross(a, b);
  const double length = glm::length(across);
  if (length > 1e-9 * glm::length(b)) return across / length;
  return glm::normalize(glm::cross(a, std::abs(a.x) < 0.6 ? DVec3(1, 0, 0) : DVec3(0, 1, 0)));
}

/// Bars along segments in the world, in one mesh.
class Bars {
 public:
  explicit Bars(const OverlayView& view) : pixel_(view) {}

  void addBox(const Frame& frame, const DVec3& lo, const DVec3& hi) {
    const double widest = widestOn(frame, lo, hi);
    for (int k = 0; k < 3; ++k)
      for (int corner = 0; corner < 4; ++corner) {
        DVec3 from = lo, to = hi;
        const int u = (k + 1) % 3, v = (k + 2) % 3;
        from[u] = to[u] = (corner & 1) != 0 ? hi[u] : lo[u];
        from[v] = to[v] = (corner & 2) != 0 ? hi[v] : lo[v];
        addBar(frame.at(from), frame.at(to), widest);
      }
  }

  /// Of lo and hi, the axis `normal` is the same.
  void addLattice(const Frame& frame, int normal, const DVec3& lo, const DVec3& hi) {
    const double widest = widestOn(frame, lo, hi);
    for (const int along : {(normal + 1) % 3, (normal + 2) % 3}) {
      const int across = 3 - normal - along;
      for (int i = 0; i <= kLatticeCells; ++i) {
        DVec3 from = lo, to = hi;
        from[across] = to[across] = lo[across] + (hi[across] - lo[across]) * i / kLatticeCells;
        addBar(frame.at(from), frame.at(to), widest);
      }
    }
  }

  void addSegment(const Frame& frame, const DVec3& from, const DVec3& to) {
    addBar(frame.at(from), frame.at(to), widestOn(frame, from, to));
  }

  mesh::Mesh take() { return std::move(mesh_); }

 private:
  static double widestOn(const Frame& frame, const DVec3& lo, const DVec3& hi) {
    return kLargestWidth * glm::distance(frame.at(lo), frame.at(hi));
  }

  double halfWidthAt(const DVec3& p, double widest) const { return 0.5 * std::min(kWidthPx * pixel_.at(p), widest); }

  /// Each end has the width that is right there: widths in a picture grow with depth as depth grows along the bar, so
  /// that they are right in between, too. One side faces the eye. Half a width longer at either end, so that corners
  /// are whole.
  void addBar(DVec3 from, DVec3 to, double widest) {
    if (!pixel_.clip(from, to)) return;
    const double length = glm::distance(from, to);
    const DVec3 along = length > 0.0 ? (to - from) / length : DVec3(1.0, 0.0, 0.0);
    const DVec3 side = unitAcross(along, pixel_.toEye(0.5 * (from + to))), front = glm::cross(side, along);
    const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
    for (int corner = 0; corner < 8; ++corner) {
      const bool is_far = (corner & 4) != 0;
      const double half = halfWidthAt(is_far ? to : from, widest);
      mesh_.positions.emplace_back((is_far ? to + half * along : from - half * along) +
                                   ((corner & 1) != 0 ? half : -half) * side +
                                   ((corner & 2) != 0 ? half : -half) * front);
    }
    constexpr std::array<mesh::Triangle, 12> kSides = {{{0, 2, 1},
                                                        {1, 2, 3},
                                                        {4, 5, 6},
                                                        {5, 7, 6},
                                                        {0, 1, 4},
                                                        {1, 5, 4},
                                                        {2, 6, 3},
                                                        {3, 6, 7},
                                                        {0, 4, 2},
                                                        {2, 4, 6},
                                                        {1, 3, 5},
                                                        {3, 7, 5}}};
    for (const mesh::Triangle& t : kSides) mesh_.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }

  PixelSize pixel_;
  mesh::Mesh mesh_;
};

scenes::Scene sceneOf(Bars bars) {
  scenes::Scene scene;
  scene.meshes.push_back(bars.take());
  scenes::Material& material = scene.materials.emplace_back();
  material.base_color = Vec4(Vec3(kDark), 1.0F);
  material.shading = scenes::Shading::kUnlit;
  material.double_sided = true;  // which way a bar is wound depends on the view
  scene.instances.emplace_back();
  return scene;
}

void addPatchBoxes(const PreparedMesh& mesh, const DMat4& world_from_object, Bars& bars) {
  for (const grouping::Patch& patch : mesh.patches)
    bars.addBox(world_from_object * Frame{}, DVec3(patch.bounds.lo), DVec3(patch.bounds.hi));
}

void addGroupPlanes(const PreparedMesh& mesh, const DMat4& world_from_object, Bars& bars) {
  for (const grouping::PatchRuns& patch : mesh.vertices.patches) {
    const Frame object = world_from_object * Frame{};
    Frame of_planes = object;
    if (patch.frame != grouping::kNoIndex) {
      const grouping::PatchFrame& own = mesh.vertices.frames[patch.frame];
      of_planes = world_from_object * Frame{DVec3(own.origin), DMat3(DVec3(own.axes.axis_s), DVec3(own.axes.axis_t),
                                                                     DVec3(own.axes.normal))};
    }
    for (std::uint32_t r = patch.first_run; r < patch.first_run + patch.run_count; ++r) {
      const grouping::VertexRun& run = mesh.vertices.runs[r];
      const DVec3 lo(run.corner_lo), hi(run.corner_hi);
      if (run.kind == grouping::RunKind::kPlane) bars.addLattice(of_planes, run.axis, lo, hi);
      if (run.kind == grouping::RunKind::kLine) bars.addSegment(object, lo, hi);
    }
  }
}

}  // namespace

scenes::Scene clusterOverlay(const mesh::Mesh& mesh, const grouping::FaceClusters& clusters,
                             std::span<const std::uint32_t> cut, const Overlay& what, const OverlayView& view,
                             const DMat4& world_from_mesh) {
  Bars bars(view);
  for (const std::uint32_t node : cut) {
    const grouping::ClusterShape shape = grouping::shapeOf(mesh, clusters, node);
    const Frame frame =
        world_from_mesh * Frame{DVec3(shape.center),
                                DMat3(DVec3(shape.frame.axis_s), DVec3(shape.frame.axis_t), DVec3(shape.frame.normal))};
    const DVec3 lo(shape.lo), hi(shape.hi);
    if (what.boxes) bars.addBox(frame, lo, hi);
    if (what.planes) bars.addLattice(frame, 2, {lo.x, lo.y, 0.0}, {hi.x, hi.y, 0.0});
  }
  return sceneOf(std::move(bars));
}

scenes::Scene patchBoxes(const PreparedScene& scene, const OverlayView& view) {
  Bars bars(view);
  for (const scenes::Instance& instance : scene.instances)
    addPatchBoxes(scene.meshes[instance.mesh], instance.world_from_object, bars);
  return sceneOf(std::move(bars));
}

scenes::Scene groupPlanes(const PreparedScene& scene, const OverlayView& view) {
  Bars bars(view);
  for (const scenes::Instance& instance : scene.instances)
    addGroupPlanes(scene.meshes[instance.mesh], instance.world_from_object, bars);
  return sceneOf(std::move(bars));
}

void addOverlay(scenes::Scene overlay, PreparedScene& scene, TaskPool& pool) {
  const auto first_mesh = static_cast<std::uint32_t>(scene.meshes.size());
  const auto first_material = static_cast<std::uint32_t>(scene.materials.size());
  PreparedScene added = prepareScene(std::move(overlay), pool);
  std::move(added.meshes.begin(), added.meshes.end(), std::back_inserter(scene.meshes));
  for (scenes::Instance& instance : added.instances) {
    instance.mesh += first_mesh;
    instance.material += first_material;
    scene.instances.push_back(instance);
  }
  // No textures: there is nothing for the materials to point to.
  scene.materials.insert(scene.materials.end(), added.materials.begin(), added.materials.end());
  scene.double_sided.insert(scene.double_sided.end(), added.double_sided.begin(), added.double_sided.end());
}

}  // namespace sheaf::pipeline
