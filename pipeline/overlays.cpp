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
constexpr double kWidth = 0.004;        ///< of a bar, as a fraction of the extent of all there is
constexpr double kLargestWidth = 0.02;  ///< the same of the diagonal of what it outlines
constexpr int kLatticeCells = 4;        ///< per side of a plane

/// A place and three axes at right angles, not all of which need a length.
struct Frame {
  DVec3 origin{0.0};
  DMat3 axes{1.0};  ///< unit

  DVec3 at(const DVec3& local) const { return origin + axes * local; }
};

/// Bars along the axes of frames, in one mesh.
class Bars {
 public:
  explicit Bars(double extent) : width_(kWidth * extent) {}

  void addBox(const Frame& frame, const DVec3& lo, const DVec3& hi) {
    const double half = halfWidth(lo, hi);
    for (int k = 0; k < 3; ++k)
      for (int corner = 0; corner < 4; ++corner) {
        DVec3 from = lo, to = hi;
        const int u = (k + 1) % 3, v = (k + 2) % 3;
        from[u] = to[u] = (corner & 1) != 0 ? hi[u] : lo[u];
        from[v] = to[v] = (corner & 2) != 0 ? hi[v] : lo[v];
        addBar(frame, from, to, half);
      }
  }

  /// Of lo and hi, the axis `normal` is the same.
  void addLattice(const Frame& frame, int normal, const DVec3& lo, const DVec3& hi) {
    const double half = halfWidth(lo, hi);
    for (const int along : {(normal + 1) % 3, (normal + 2) % 3}) {
      const int across = 3 - normal - along;
      for (int i = 0; i <= kLatticeCells; ++i) {
        DVec3 from = lo, to = hi;
        from[across] = to[across] = lo[across] + (hi[across] - lo[across]) * i / kLatticeCells;
        addBar(frame, from, to, half);
      }
    }
  }

  /// From one place to another, neither of which is given in a frame.
  void addSegment(const DVec3& from, const DVec3& to) {
    const double length = glm::length(to - from);
    if (!(length > 0.0)) return;
    const DVec3 z = (to - from) / length;
    const DVec3 x = glm::normalize(glm::cross(z, std::abs(z.x) < 0.6 ? DVec3(1, 0, 0) : DVec3(0, 1, 0)));
    const DVec3 end(0.0, 0.0, length);
    addBar({from, DMat3(x, glm::cross(z, x), z)}, DVec3(0.0), end, halfWidth(DVec3(0.0), end));
  }

  mesh::Mesh take() { return std::move(mesh_); }

 private:
  double halfWidth(const DVec3& lo, const DVec3& hi) const {
    return 0.5 * std::min(width_, kLargestWidth * glm::length(hi - lo));
  }

  /// Half a width longer at either end, so that corners are whole.
  void addBar(const Frame& frame, const DVec3& from, const DVec3& to, double half) {
    const DVec3 lo = glm::min(from, to) - half, hi = glm::max(from, to) + half;
    const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
    for (int corner = 0; corner < 8; ++corner) {
      const DVec3 local((corner & 1) != 0 ? hi.x : lo.x, (corner & 2) != 0 ? hi.y : lo.y,
                        (corner & 4) != 0 ? hi.z : lo.z);
      mesh_.positions.emplace_back(frame.at(local));
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

  double width_;
  mesh::Mesh mesh_;
};

/// Without meshes and instances.
scenes::Scene emptyOverlay() {
  scenes::Scene scene;
  scenes::Material& material = scene.materials.emplace_back();
  material.base_color = Vec4(Vec3(kDark), 1.0F);
  material.shading = scenes::Shading::kUnlit;
  material.double_sided = true;  // frames of clusters may be left-handed, instances mirrored
  return scene;
}

double worldExtentOf(const PreparedScene& scene) {
  Box3 world;
  for (const scenes::Instance& instance : scene.instances) {
    const Box3& box = scene.meshes[instance.mesh].bounds;
    if (box.empty()) continue;
    for (int corner = 0; corner < 8; ++corner) {
      const DVec3 p((corner & 1) != 0 ? box.hi.x : box.lo.x, (corner & 2) != 0 ? box.hi.y : box.lo.y,
                    (corner & 4) != 0 ? box.hi.z : box.lo.z);
      world.extend(Vec3(DVec3(instance.world_from_object * DVec4(p, 1.0))));
    }
  }
  return world.longestEdge();
}

/// The overlay of each mesh, where the mesh's instances stand. Bars are as wide in all of them, in the world, unless
/// instances of one mesh are of different size.
scenes::Scene overlayByMesh(const PreparedScene& scene, mesh::Mesh (*overlay_of)(const PreparedMesh&, double extent)) {
  const double world_extent = worldExtentOf(scene);
  std::vector<double> extent(scene.meshes.size(), 0.0);  // the same in the units of each mesh
  for (const scenes::Instance& instance : scene.instances) {
    const double scale = std::cbrt(std::abs(glm::determinant(DMat3(instance.world_from_object))));
    if (scale > 0.0) extent[instance.mesh] = world_extent / scale;
  }
  scenes::Scene overlay = emptyOverlay();
  for (std::size_t m = 0; m < scene.meshes.size(); ++m)
    overlay.meshes.push_back(overlay_of(scene.meshes[m], extent[m]));
  for (const scenes::Instance& instance : scene.instances)
    overlay.instances.push_back({instance.mesh, 0, instance.world_from_object});
  return overlay;
}

mesh::Mesh patchBoxesOf(const PreparedMesh& mesh, double extent) {
  Bars bars(extent);
  for (const grouping::Patch& patch : mesh.patches) bars.addBox({}, DVec3(patch.bounds.lo), DVec3(patch.bounds.hi));
  return bars.take();
}

mesh::Mesh groupPlanesOf(const PreparedMesh& mesh, double extent) {
  Bars bars(extent);
  for (const grouping::PatchRuns& patch : mesh.vertices.patches) {
    Frame frame;
    if (patch.frame != grouping::kNoIndex) {
      const grouping::PatchFrame& own = mesh.vertices.frames[patch.frame];
      frame = {DVec3(own.origin), DMat3(DVec3(own.axes.axis_s), DVec3(own.axes.axis_t), DVec3(own.axes.normal))};
    }
    for (std::uint32_t r = patch.first_run; r < patch.first_run + patch.run_count; ++r) {
      const grouping::VertexRun& run = mesh.vertices.runs[r];
      const DVec3 lo(run.corner_lo), hi(run.corner_hi);
      if (run.kind == grouping::RunKind::kPlane) bars.addLattice(frame, run.axis, lo, hi);
      if (run.kind == grouping::RunKind::kLine) bars.addSegment(lo, hi);
    }
  }
  return bars.take();
}

}  // namespace

scenes::Scene clusterOverlay(const mesh::Mesh& mesh, const grouping::FaceClusters& clusters,
                             std::span<const std::uint32_t> cut, const Overlay& what, const DMat4& world_from_mesh) {
  Bars bars(mesh::boundsOf(mesh).longestEdge());
  for (const std::uint32_t node : cut) {
    const grouping::ClusterShape shape = grouping::shapeOf(mesh, clusters, node);
    const Frame frame{DVec3(shape.center),
                      DMat3(DVec3(shape.frame.axis_s), DVec3(shape.frame.axis_t), DVec3(shape.frame.normal))};
    const DVec3 lo(shape.lo), hi(shape.hi);
    if (what.boxes) bars.addBox(frame, lo, hi);
    if (what.planes) bars.addLattice(frame, 2, {lo.x, lo.y, 0.0}, {hi.x, hi.y, 0.0});
  }
  scenes::Scene overlay = emptyOverlay();
  overlay.meshes.push_back(bars.take());
  overlay.instances.push_back({0, 0, world_from_mesh});
  return overlay;
}

scenes::Scene patchBoxes(const PreparedScene& scene) {
  return overlayByMesh(scene, patchBoxesOf);
}

scenes::Scene groupPlanes(const PreparedScene& scene) {
  return overlayByMesh(scene, groupPlanesOf);
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
