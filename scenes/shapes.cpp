#include "scenes/shapes.h"

#include <cassert>

namespace sheaf::scenes {
namespace {

void addTriangle(mesh::Mesh& m, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  const std::vector<Vec3>& p = m.positions;
  if (p[a] != p[b] && p[b] != p[c] && p[c] != p[a]) m.triangles.push_back({a, b, c});
}

/// A flat quad, counter-clockwise from its top left corner seen from outside.
void addFlatQuad(mesh::Mesh& m, const std::array<DVec3, 4>& corners) {
  static constexpr std::array<Vec2, 4> kTexcoords = {Vec2(0.0F, 0.0F), Vec2(0.0F, 1.0F), Vec2(1.0F, 1.0F),
                                                     Vec2(1.0F, 0.0F)};
  const auto first = static_cast<std::uint32_t>(m.vertexCount());
  const DVec3 normal = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
  for (std::size_t i = 0; i < 4; ++i) {
    m.positions.emplace_back(corners[i]);
    m.normals.emplace_back(normal);
    m.texcoords.push_back(kTexcoords[i]);
  }
  m.triangles.push_back({first, first + 1, first + 2});
  m.triangles.push_back({first, first + 2, first + 3});
}

}  // namespace

mesh::Mesh gridSurface(const GridShape& shape, const std::function<SurfacePoint(double u, double v)>& surface) {
  assert(shape.columns > 0 && shape.rows > 0);
  mesh::Mesh m;
  for (int j = 0; j <= shape.rows; ++j)
    for (int i = 0; i <= shape.columns; ++i) {
      const double u = static_cast<double>(i) / shape.columns;
      const double v = static_cast<double>(j) / shape.rows;
      const SurfacePoint p =
          surface(shape.closed_u && i == shape.columns ? 0.0 : u, shape.closed_v && j == shape.rows ? 0.0 : v);
      m.positions.emplace_back(p.position);
      m.normals.emplace_back(glm::normalize(p.normal));
      m.texcoords.emplace_back(u, v);
    }
  const auto stride = static_cast<std::uint32_t>(shape.columns + 1);
  for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(shape.rows); ++j)
    for (std::uint32_t i = 0; i + 1 < stride; ++i) {
      const std::uint32_t top_left = j * stride + i;
      addTriangle(m, top_left, top_left + stride, top_left + stride + 1);
      addTriangle(m, top_left, top_left + stride + 1, top_left + 1);
    }
  return m;
}

CurvePoint bezier(const std::array<DVec3, 4>& points, double t) {
  const double s = 1.0 - t;
  return {s * s * s * points[0] + 3.0 * s * s * t * points[1] + 3.0 * s * t * t * points[2] + t * t * t * points[3],
          3.0 * s * s * (points[1] - points[0]) + 6.0 * s * t * (points[2] - points[1]) +
              3.0 * t * t * (points[3] - points[2])};
}

ProfilePiece straightPiece(double r0, double y0, double r1, double y1) {
  const double dr = (r1 - r0) / 3.0;
  const double dy = (y1 - y0) / 3.0;
  return {{{r0, y0}, {r0 + dr, y0 + dy}, {r1 - dr, y1 - dy}, {r1, y1}}};
}

mesh::Mesh revolve(std::span<const ProfilePiece> profile, int columns, int rows) {
  mesh::Mesh whole;
  const auto count = static_cast<double>(profile.size());
  for (std::size_t piece = 0; piece < profile.size(); ++piece) {
    std::array<DVec3, 4> points;
    for (std::size_t i = 0; i < 4; ++i) points[i] = DVec3(profile[piece][i][0], profile[piece][i][1], 0.0);
    mesh::Mesh part = gridSurface({columns, rows, true, false}, [&](double u, double v) {
      const CurvePoint p = bezier(points, v);
      const double angle = 2.0 * kPi * u;
      const DVec3 outwards(std::sin(angle), 0.0, std::cos(angle));
      return SurfacePoint{outwards * p.position.x + DVec3(0.0, p.position.y, 0.0),
                          outwards * -p.derivative.y + DVec3(0.0, p.derivative.x, 0.0)};
    });
    for (Vec2& uv : part.texcoords)
      uv.y = static_cast<float>((static_cast<double>(piece) + static_cast<double>(uv.y)) / count);
    append(whole, part);
  }
  return whole;
}

mesh::Mesh boxMesh(const DVec3& lo, const DVec3& hi) {
  const auto corner = [&](int x, int y, int z) {
    return DVec3(x != 0 ? hi.x : lo.x, y != 0 ? hi.y : lo.y, z != 0 ? hi.z : lo.z);
  };
  mesh::Mesh m;
  addFlatQuad(m, {corner(0, 1, 1), corner(0, 0, 1), corner(1, 0, 1), corner(1, 1, 1)});  // front
  addFlatQuad(m, {corner(1, 1, 0), corner(1, 0, 0), corner(0, 0, 0), corner(0, 1, 0)});  // back
  addFlatQuad(m, {corner(0, 1, 0), corner(0, 0, 0), corner(0, 0, 1), corner(0, 1, 1)});  // left
  addFlatQuad(m, {corner(1, 1, 1), corner(1, 0, 1), corner(1, 0, 0), corner(1, 1, 0)});  // right
  addFlatQuad(m, {corner(0, 1, 0), corner(0, 1, 1), corner(1, 1, 1), corner(1, 1, 0)});  // top
  addFlatQuad(m, {corner(0, 0, 1), corner(0, 0, 0), corner(1, 0, 0), corner(1, 0, 1)});  // bottom
  return m;
}

mesh::Mesh prismMesh(std::span<const std::array<double, 2>> footprint_xz, double bottom, double top) {
  assert(footprint_xz.size() >= 3);
  mesh::Mesh m;
  const std::size_t n = footprint_xz.size();
  const auto at = [&](std::size_t i, double y) { return DVec3(footprint_xz[i % n][0], y, footprint_xz[i % n][1]); };
  for (std::size_t i = 0; i < n; ++i) addFlatQuad(m, {at(i, top), at(i, bottom), at(i + 1, bottom), at(i + 1, top)});
  for (const bool is_top : {true, false}) {
    const auto first = static_cast<std::uint32_t>(m.vertexCount());
    for (std::size_t i = 0; i < n; ++i) {
      m.positions.emplace_back(at(i, is_top ? top : bottom));
      m.normals.emplace_back(0.0F, is_top ? 1.0F : -1.0F, 0.0F);
      m.texcoords.emplace_back(footprint_xz[i][0], footprint_xz[i][1]);
    }
    for (std::uint32_t i = 1; i + 1 < n; ++i) {
      if (is_top)
        m.triangles.push_back({first, first + i, first + i + 1});
      else
        m.triangles.push_back({first, first + i + 1, first + i});
    }
  }
  return m;
}

namespace {

/// Index of the point (x, y, z) of a cube's surface, each coordinate in [0, n]: layer by layer along z, of which the
/// first and last are full and the ones between are rings.
class CubeSurface {
 public:
  explicit CubeSurface(int n) : n_(n) {}

  std::uint32_t count() const { return static_cast<std::uint32_t>(6 * n_ * n_ + 2); }

  std::uint32_t index(int x, int y, int z) const {
    const int full = (n_ + 1) * (n_ + 1);
    if (z == 0) return static_cast<std::uint32_t>(y * (n_ + 1) + x);
    if (z == n_) return static_cast<std::uint32_t>(full + (n_ - 1) * 4 * n_ + y * (n_ + 1) + x);
    return static_cast<std::uint32_t>(full + (z - 1) * 4 * n_ + ring(x, y));
  }

 private:
  // Position on the ring around a layer, counter-clockwise from (0, 0).
  int ring(int x, int y) const {
    if (y == 0) return x;
    if (x == n_) return n_ + y;
    if (y == n_) return 3 * n_ - x;
    return 4 * n_ - y;
  }

  int n_;
};

/// From the cube [-1, 1]^3 to the sphere with less distortion than normalising: spreads the squares evenly.
DVec3 spherePoint(const DVec3& c) {
  const DVec3 q = c * c;
  return {c.x * std::sqrt(1.0 - q.y / 2.0 - q.z / 2.0 + q.y * q.z / 3.0),
          c.y * std::sqrt(1.0 - q.z / 2.0 - q.x / 2.0 + q.z * q.x / 3.0),
          c.z * std::sqrt(1.0 - q.x / 2.0 - q.y / 2.0 + q.x * q.y / 3.0)};
}

}  // namespace

mesh::Mesh cubeSphere(int n) {
  assert(n > 0);
  const CubeSurface cube(n);
  mesh::Mesh m;
  m.positions.resize(cube.count());
  m.normals.resize(cube.count());
  m.triangles.reserve(static_cast<std::size_t>(12) * static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, n}) {
      // (a, b, axis) is a right-handed triple, so a x b points outwards on the far side.
      const int a = (axis + 1) % 3;
      const int b = (axis + 2) % 3;
      const auto lattice = [&](int i, int j) {
        std::array<int, 3> c{};
        c[static_cast<std::size_t>(axis)] = side;
        c[static_cast<std::size_t>(a)] = i;
        c[static_cast<std::size_t>(b)] = j;
        return c;
      };
      const auto index = [&](int i, int j) {
        const std::array<int, 3> c = lattice(i, j);
        return cube.index(c[0], c[1], c[2]);
      };
      for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {
          const std::array<int, 3> c = lattice(i, j);
          const DVec3 on_cube(2.0 * c[0] / n - 1.0, 2.0 * c[1] / n - 1.0, 2.0 * c[2] / n - 1.0);
          const DVec3 p = spherePoint(on_cube);
          m.positions[index(i, j)] = Vec3(p);
          m.normals[index(i, j)] = Vec3(glm::normalize(p));
        }
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          std::array<std::uint32_t, 4> q = {index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)};
          if (side == 0) std::swap(q[1], q[3]);
          m.triangles.push_back({q[0], q[1], q[2]});
          m.triangles.push_back({q[0], q[2], q[3]});
        }
    }
  return m;
}

mesh::Mesh globeMesh(int columns, int rows) {
  return gridSurface({columns, rows, true, false}, [](double u, double v) {
    const double longitude = 2.0 * kPi * u;
    // sin(pi) is not 0: at the poles all longitudes must meet in one point.
    const double radius = v == 0.0 || v == 1.0 ? 0.0 : std::sin(kPi * v);
    const DVec3 p(radius * std::sin(longitude), std::cos(kPi * v), radius * std::cos(longitude));
    return SurfacePoint{p, p};
  });
}

mesh::Mesh torusKnotMesh(const TorusKnot& knot, int columns, int rows) {
  struct Axis {
    DVec3 position;
    DVec3 derivative;
  };
  const auto axis = [&](double u) {
    const double p = knot.turns_about_axis;
    const double q = knot.turns_through_hole;
    const double t = 2.0 * kPi * u;
    const double r = knot.major_radius + knot.minor_radius * std::cos(q * t);
    const double dr = -q * knot.minor_radius * std::sin(q * t);
    return Axis{DVec3(r * std::sin(p * t), knot.minor_radius * std::sin(q * t), r * std::cos(p * t)),
                DVec3(dr * std::sin(p * t) + p * r * std::cos(p * t), q * knot.minor_radius * std::cos(q * t),
                      dr * std::cos(p * t) - p * r * std::sin(p * t))};
  };
  return gridSurface({columns, rows, true, true}, [&](double u, double v) {
    const Axis a = axis(u);
    const double t = 2.0 * kPi * u;
    const double about = knot.turns_about_axis * t;
    const double through = knot.turns_through_hole * t;
    // The torus' own normal is a frame that closes after the last turn, which a transported frame need not do.
    const DVec3 away(std::cos(through) * std::sin(about), std::sin(through), std::cos(through) * std::cos(about));
    const DVec3 aside = glm::normalize(glm::cross(a.derivative, away));
    const double angle = 2.0 * kPi * v;
    const DVec3 normal = std::cos(angle) * away + std::sin(angle) * aside;
    return SurfacePoint{a.position + knot.tube_radius * normal, normal};
  });
}

void append(mesh::Mesh& whole, const mesh::Mesh& part) {
  const auto first = static_cast<std::uint32_t>(whole.vertexCount());
  const auto add = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  add(whole.positions, part.positions);
  add(whole.normals, part.normals);
  add(whole.texcoords, part.texcoords);
  add(whole.colors, part.colors);
  for (const mesh::Triangle& t : part.triangles) whole.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

}  // namespace sheaf::scenes
