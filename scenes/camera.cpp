#include "scenes/camera.h"

#include <cassert>
#include <numeric>
#include <utility>

#include "core/error.h"

namespace sheaf::scenes {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The elevation at which the three axes of a cube look equally long: atan(1 / sqrt(2)).
constexpr double kIsometricElevation = 0.6154797086703873;

/// The eye keeps this part of the scene's extent away from the nearest vertex, so that a near plane fits between.
constexpr double kLeastDistance = 0.01;

/// Right, up and backward (towards the eye) of a camera: its x, y and z in world space.
struct Frame {
  DVec3 right;
  DVec3 up;
  DVec3 back;
};

/// An orthonormal frame; where `up` is (nearly) along the view it is replaced by the world axis that suits best.
Frame frameOf(const DVec3& to_eye, const DVec3& up) {
  Frame f;
  const double length = glm::length(to_eye);
  f.back = length > 0.0 ? to_eye / length : DVec3(0.0, 0.0, 1.0);
  const double up_length = glm::length(up);
  DVec3 right = up_length > 0.0 ? glm::cross(up / up_length, f.back) : DVec3(0.0);
  if (glm::length(right) < 1e-6) {
    // From above, up on the picture is away from the front (-Z); from below, towards it; else it is +Y.
    const DVec3 other = std::abs(f.back.y) > 0.9 ? DVec3(0.0, 0.0, f.back.y > 0.0 ? -1.0 : 1.0) : DVec3(0.0, 1.0, 0.0);
    right = glm::cross(other, f.back);
  }
  f.right = glm::normalize(right);
  f.up = glm::cross(f.back, f.right);
  return f;
}

Frame frameOf(const Camera& camera) {
  return frameOf(camera.eye - camera.target, camera.up);
}

DMat4 rotationInto(const Frame& f) {
  return DMat4(DVec4(f.right.x, f.up.x, f.back.x, 0.0), DVec4(f.right.y, f.up.y, f.back.y, 0.0),
               DVec4(f.right.z, f.up.z, f.back.z, 0.0), DVec4(0.0, 0.0, 0.0, 1.0));
}

std::array<DVec3, 8> cornersOf(const Box3& box) {
  std::array<DVec3, 8> corners;
  for (std::size_t i = 0; i < 8; ++i)
    corners[i] = DVec3((i & 1) ? box.hi.x : box.lo.x, (i & 2) ? box.hi.y : box.lo.y, (i & 4) ? box.hi.z : box.lo.z);
  return corners;
}

/// Answers "which drawn vertex lies farthest in some sense" exactly, without a look at every vertex of every instance.
class VertexSearch {
 public:
  VertexSearch(const Scene& scene, const Frame& frame) : scene_(scene) {
    std::vector<Box3> boxes;
    boxes.reserve(scene.meshes.size());
    for (const mesh::Mesh& m : scene.meshes) boxes.push_back(mesh::boundsOf(m));
    used_.resize(scene.meshes.size());
    const DMat4 rotation = rotationInto(frame);
    for (const Instance& instance : scene.instances) {
      const Box3& box = boxes[instance.mesh];
      if (box.empty()) continue;
      Candidate c{instance.mesh, rotation * instance.world_from_object, cornersOf(box)};
      for (DVec3& corner : c.corners) corner = DVec3(c.frame_from_object * DVec4(corner, 1.0));
      candidates_.push_back(c);
    }
  }

  bool empty() const { return candidates_.empty(); }

  /// The vertex, in the frame's coordinates, with the greatest score(vertex). A score must be quasi-convex (its maximum
  /// over a box is at a corner), as linear and linear-fractional functions are: instances whose box cannot win are
  /// skipped, so thousands of instances cost little more than one.
  template <typename Score>
  DVec3 farthest(const Score& score) {
    assert(!empty());
    std::vector<std::pair<double, std::size_t>> bounds;
    bounds.reserve(candidates_.size());
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      double bound = -kInfinity;
      for (const DVec3& corner : candidates_[i].corners) bound = std::max(bound, score(corner));
      bounds.emplace_back(-bound, i);
    }
    std::sort(bounds.begin(), bounds.end());
    DVec3 best(0.0);
    double best_score = -kInfinity;
    for (const auto& [negative_bound, index] : bounds) {
      if (-negative_bound <= best_score) break;
      const Candidate& c = candidates_[index];
      for (const Vec3& vertex : usedVertices(c.mesh)) {
        const DVec3 p(c.frame_from_object * DVec4(DVec3(vertex), 1.0));
        if (const double s = score(p); s > best_score) {
          best_score = s;
          best = p;
        }
      }
    }
    return best;
  }

 private:
  struct Candidate {
    std::uint32_t mesh;
    DMat4 frame_from_object;
    std::array<DVec3, 8> corners;  // of the mesh's box, in the frame
  };

  /// Vertices that no triangle uses are not seen, so they must not count. Gathered when first asked for.
  const std::vector<Vec3>& usedVertices(std::uint32_t mesh_index) {
    std::vector<Vec3>& vertices = used_[mesh_index];
    if (!vertices.empty()) return vertices;
    const mesh::Mesh& m = scene_.meshes[mesh_index];
    std::vector<bool> is_used(m.vertexCount(), false);
    for (const mesh::Triangle& t : m.triangles)
      for (const std::uint32_t v : t) is_used[v] = true;
    for (std::size_t v = 0; v < m.vertexCount(); ++v)
      if (is_used[v]) vertices.push_back(m.positions[v]);
    return vertices;
  }

  const Scene& scene_;
  std::vector<Candidate> candidates_;
  std::vector<std::vector<Vec3>> used_;  // per mesh
};

/// What the vertices span along one axis of the frame.
struct Span {
  double lo;
  double hi;
  double size() const { return hi - lo; }
  double middle() const { return lo + 0.5 * (hi - lo); }
};

Span spanAlong(VertexSearch& search, int axis) {
  return {search.farthest([axis](const DVec3& p) { return -p[axis]; })[axis],
          search.farthest([axis](const DVec3& p) { return p[axis]; })[axis]};
}

/// Least z at which an eye sees everything between two planes through it, x = eye.x +- slope * (eye.z - z). Each vertex
/// asks for eye.x + slope * eye.z >= x + slope * z and -eye.x + slope * eye.z >= -x + slope * z; the sum of the two
/// hardest is free of eye.x.
double leastEyeDepth(VertexSearch& search, int axis, double slope) {
  const DVec3 above = search.farthest([=](const DVec3& p) { return p[axis] + slope * p.z; });
  const DVec3 below = search.farthest([=](const DVec3& p) { return -p[axis] + slope * p.z; });
  return (above[axis] + slope * above.z - below[axis] + slope * below.z) / (2.0 * slope);
}

/// Where the eye must be along `axis` for the picture's first and last vertex to be equally far from its middle, given
/// the eye's depth. The two vertices depend on the answer: repeated until they stay the same, which takes a few rounds.
double centeredEye(VertexSearch& search, int axis, double eye_z, double start) {
  double eye = start;
  for (int round = 0; round < 16; ++round) {
    const auto tangent = [&](const DVec3& p) { return p.z < eye_z ? (p[axis] - eye) / (eye_z - p.z) : kInfinity; };
    const auto negative_tangent = [&](const DVec3& p) {
      return p.z < eye_z ? (eye - p[axis]) / (eye_z - p.z) : kInfinity;
    };
    const DVec3 last = search.farthest(tangent);
    const DVec3 first = search.farthest(negative_tangent);
    const double last_weight = 1.0 / (eye_z - last.z);
    const double first_weight = 1.0 / (eye_z - first.z);
    const double next = (last[axis] * last_weight + first[axis] * first_weight) / (last_weight + first_weight);
    if (next == eye) break;
    eye = next;
  }
  return eye;
}

DVec3 toWorld(const Frame& f, const DVec3& p) {
  return f.right * p.x + f.up * p.y + f.back * p.z;
}

Scene unitBoxScene() {
  Scene scene;
  mesh::Mesh box;
  for (const DVec3& corner : cornersOf({Vec3(-0.5F), Vec3(0.5F)})) box.positions.emplace_back(corner);
  box.triangles = {{0, 1, 2}, {3, 4, 5}, {5, 6, 7}};
  scene.meshes.push_back(std::move(box));
  scene.instances.emplace_back();
  return scene;
}

}  // namespace

ViewDirection orbitView(double azimuth_rad, double elevation_rad) {
  const double sin_a = std::sin(azimuth_rad);
  const double cos_a = std::cos(azimuth_rad);
  const double sin_e = std::sin(elevation_rad);
  const double cos_e = std::cos(elevation_rad);
  // Up is the derivative by the elevation, so it stays sound over the poles.
  return {DVec3(cos_e * sin_a, sin_e, cos_e * cos_a), DVec3(-sin_e * sin_a, cos_e, -sin_e * cos_a)};
}

static const std::vector<std::pair<std::string, ViewDirection>>& namedDirections() {
  static const std::vector<std::pair<std::string, ViewDirection>> directions = {
      {"front", {DVec3(0.0, 0.0, 1.0), DVec3(0.0, 1.0, 0.0)}},
      {"back", {DVec3(0.0, 0.0, -1.0), DVec3(0.0, 1.0, 0.0)}},
      {"left", {DVec3(-1.0, 0.0, 0.0), DVec3(0.0, 1.0, 0.0)}},
      {"right", {DVec3(1.0, 0.0, 0.0), DVec3(0.0, 1.0, 0.0)}},
      {"top", {DVec3(0.0, 1.0, 0.0), DVec3(0.0, 0.0, -1.0)}},
      {"bottom", {DVec3(0.0, -1.0, 0.0), DVec3(0.0, 0.0, 1.0)}},
      {"iso", orbitView(radians(45.0), kIsometricElevation)},
      {"iso-left", orbitView(radians(-45.0), kIsometricElevation)},
      {"iso-back", orbitView(radians(135.0), kIsometricElevation)},
      {"iso-back-left", orbitView(radians(-135.0), kIsometricElevation)},
  };
  return directions;
}

const std::vector<std::string>& namedViews() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> result;
    for (const auto& [name, direction] : namedDirections()) result.push_back(name);
    return result;
  }();
  return names;
}

ViewDirection namedView(const std::string& name) {
  std::string known;
  for (const auto& [candidate, direction] : namedDirections()) {
    if (candidate == name) return direction;
    known += (known.empty() ? "" : ", ") + candidate;
  }
  throw Error(ErrorCode::kUsage, "view " + name + ": no such view; there are " + known);
}

Camera fitCamera(const Scene& scene, const ViewDirection& view, double aspect, double vertical_fov_rad,
                 bool orthographic, double margin) {
  assert(aspect > 0.0 && margin >= 0.0 && margin < 0.5);
  assert(orthographic || (vertical_fov_rad > 0.0 && vertical_fov_rad < kPi));
  const Frame frame = frameOf(view.to_eye, view.up);
  VertexSearch search(scene, frame);
  if (search.empty()) return fitCamera(unitBoxScene(), view, aspect, vertical_fov_rad, orthographic, margin);

  const Span x = spanAlong(search, 0);
  const Span y = spanAlong(search, 1);
  const Span z = spanAlong(search, 2);
  const double longest = std::max({x.size(), y.size(), z.size()});
  const double extent = longest > 0.0 ? longest : 1.0;  // a single point: any size will do
  const double room = 1.0 - 2.0 * margin;               // the part of the picture's side that may be covered

  Camera camera;
  camera.up = frame.up;
  DVec3 eye(x.middle(), y.middle(), z.hi + extent);
  if (orthographic) {
    const double height = std::max(y.size(), x.size() / aspect) / room;
    camera.orthographic_height = height > kLeastDistance * extent ? height : extent;
  } else {
    camera.vertical_fov_rad = vertical_fov_rad;
    const double slope_y = std::tan(0.5 * vertical_fov_rad) * room;
    const double slope_x = slope_y * aspect;
    const double nearest_eye = x.size() > 0.0 || y.size() > 0.0 ? z.hi + kLeastDistance * extent : z.hi + extent;
    eye.z = std::max({leastEyeDepth(search, 0, slope_x), leastEyeDepth(search, 1, slope_y), nearest_eye});
    eye.x = centeredEye(search, 0, eye.z, eye.x);
    eye.y = centeredEye(search, 1, eye.z, eye.y);
  }
  camera.eye = toWorld(frame, eye);
  camera.target = toWorld(frame, DVec3(eye.x, eye.y, z.middle()));
  return camera;
}

Camera fitClipPlanes(Camera camera, const Box3& world_bounds) {
  if (camera.near > 0.0 && camera.far > 0.0) return camera;
  const Frame frame = frameOf(camera);
  double nearest = kInfinity;
  double farthest = -kInfinity;
  if (world_bounds.empty()) {
    const double distance = glm::length(camera.eye - camera.target);
    nearest = 0.5 * distance;
    farthest = 2.0 * distance;
  } else {
    for (const DVec3& corner : cornersOf(world_bounds)) {
      const double depth = glm::dot(camera.eye - corner, frame.back);
      nearest = std::min(nearest, depth);
      farthest = std::max(farthest, depth);
    }
  }
  // The spare room also covers what rounding to float moves the vertices by.
  const double spare = 0.01 * (farthest - nearest) + 1e-5 * std::max(std::abs(nearest), std::abs(farthest));
  nearest -= spare;
  farthest += spare;
  if (!(farthest > 0.0)) farthest = 1.0;  // everything is behind the eye: any valid planes will do
  if (camera.far > 0.0) farthest = camera.far;
  if (camera.near > 0.0) nearest = camera.near;
  // An eye within the box: with reversed float depth this ratio still resolves a ten-thousandth of the distance.
  const double least_near = 1e-4 * farthest;
  if (camera.near <= 0.0) camera.near = std::max(nearest, least_near);
  if (camera.near >= farthest) {
    // One plane was given and the scene lies on its wrong side.
    if (camera.far > 0.0)
      camera.near = 0.5 * camera.far;
    else
      farthest = 2.0 * camera.near;
  }
  camera.far = farthest;
  return camera;
}

DMat4 viewFromWorld(const Camera& camera) {
  const Frame frame = frameOf(camera);
  DMat4 view_from_world = rotationInto(frame);
  view_from_world[3] = DVec4(-glm::dot(frame.right, camera.eye), -glm::dot(frame.up, camera.eye),
                             -glm::dot(frame.back, camera.eye), 1.0);
  return view_from_world;
}

DMat4 clipFromView(const Camera& camera, double aspect) {
  assert(aspect > 0.0 && camera.near > 0.0 && camera.far > camera.near);
  const double depth = camera.far - camera.near;
  DMat4 clip(0.0);
  if (camera.orthographic_height > 0.0) {
    clip[0][0] = 2.0 / (camera.orthographic_height * aspect);
    clip[1][1] = 2.0 / camera.orthographic_height;
    clip[2][2] = 1.0 / depth;
    clip[3][2] = camera.far / depth;
    clip[3][3] = 1.0;
  } else {
    const double focal = 1.0 / std::tan(0.5 * camera.vertical_fov_rad);
    clip[0][0] = focal / aspect;
    clip[1][1] = focal;
    clip[2][2] = camera.near / depth;
    clip[3][2] = camera.far * (camera.near / depth);
    clip[2][3] = -1.0;
  }
  return clip;
}

void addDefaultLights(Scene& scene, const Camera& camera) {
  if (!scene.lights.empty()) return;
  const Frame f = frameOf(camera);
  const auto light = [&](double right, double up, double back, const Vec3& radiance) {
    const DVec3 direction = glm::normalize(right * f.right + up * f.up + back * f.back);
    scene.lights.push_back({Vec3(direction), radiance});
  };
  // Key, fill and sky together return at most 0.95 from a white Lambert surface, however it is turned, so that a white
  // model keeps its shape; the key is a little warm, the fill and the sky a little cool, the ground gives some back.
  light(-0.55, 0.75, 0.70, Vec3(0.74F, 0.72F, 0.69F));
  light(0.85, 0.05, 0.45, Vec3(0.14F, 0.15F, 0.17F));
  scene.ambient.sky = Vec3(0.20F, 0.21F, 0.23F);
  scene.ambient.ground = Vec3(0.11F, 0.10F, 0.09F);
}

}  // namespace sheaf::scenes
