#include "grouping/compression.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>

#include "grouping/plane_sets.h"

namespace sheaf::grouping {
namespace {

// Origin or end of a group, plane, and number of members: what a record needs beside the members.
constexpr double kRecordBits = 32.0 + 8.0 + 32.0;
// Three angles of a frame.
constexpr double kFrameBits = 3.0 * 16.0;

// Frames that some group is in. Those of the axes need not be stored, nor the frame of a patch without groups.
double frameBits(const VertexGroups& groups) {
  if (groups.planes == axisPlanes()) return 0.0;
  std::vector<bool> used(groups.planes.size(), false);
  for (const VertexGroup& g : groups.groups)
    if (g.kind == GroupKind::kPlane) used[g.plane] = true;
  return kFrameBits * static_cast<double>(std::count(used.begin(), used.end(), true));
}

// Place of each vertex in an order that puts vertices of neighbouring triangles together; unused vertices come last.
std::vector<std::uint32_t> placesOf(const mesh::Mesh& mesh) {
  std::vector<std::uint32_t> place(mesh.vertexCount());
  if (mesh.triangles.empty()) {
    for (std::uint32_t v = 0; v < place.size(); ++v) place[v] = v;
    return place;
  }
  std::vector<std::uint32_t> corners;
  for (const mesh::Triangle& t : mesh.triangles) corners.insert(corners.end(), t.begin(), t.end());
  meshopt_optimizeVertexCache(corners.data(), corners.data(), corners.size(), mesh.vertexCount());
  meshopt_optimizeVertexFetchRemap(place.data(), corners.data(), corners.size(), mesh.vertexCount());
  return place;
}

// Vertices that are in use, and for which `wanted` holds, in their order.
template <class Wanted>
std::vector<std::uint32_t> inOrder(const VertexGroups& groups, std::span<const std::uint32_t> place,
                                   const Wanted& wanted) {
  std::vector<std::uint32_t> vertices;
  for (std::uint32_t v = 0; v < groups.state.size(); ++v)
    if (groups.state[v] != VertexState::kUnused && wanted(v)) vertices.push_back(v);
  std::sort(vertices.begin(), vertices.end(), [&](auto a, auto b) { return place[a] < place[b]; });
  return vertices;
}

// kComponents numbers of 16 bits to a vertex, a multiple of 2 since the codec wants multiples of 4 bytes.
template <std::size_t kComponents>
double codedBits(const std::vector<std::array<std::uint16_t, kComponents>>& values) {
  if (values.empty()) return 0.0;
  constexpr std::size_t kStride = kComponents * sizeof(std::uint16_t);
  std::vector<unsigned char> buffer(meshopt_encodeVertexBufferBound(values.size(), kStride));
  const std::size_t bytes =
      meshopt_encodeVertexBuffer(buffer.data(), buffer.size(), values.data(), values.size(), kStride);
  return 8.0 * static_cast<double>(bytes);
}

std::uint16_t gridCode(double value, double least, double step) {
  const double code = step > 0.0 ? std::round((value - least) / step) : 0.0;
  return static_cast<std::uint16_t>(std::clamp(code, 0.0, 65535.0));
}

double codedPositions(const std::vector<Vec3>& positions, const Vec3& least, double step) {
  std::vector<std::array<std::uint16_t, 4>> codes;
  for (const Vec3& p : positions)
    codes.push_back({gridCode(p.x, least.x, step), gridCode(p.y, least.y, step), gridCode(p.z, least.z, step), 0});
  return codedBits(codes);
}

// Members of each group in vertex order, as steps from the least parameter; lines have a parameter of their own length.
double codedParameters(const VertexGroups& groups, std::span<const std::uint32_t> place, double step) {
  std::vector<std::array<std::uint16_t, 2>> codes;
  std::vector<std::uint32_t> members;
  for (const VertexGroup& g : groups.groups) {
    members.clear();
    for (std::uint32_t m = g.first_member; m < g.first_member + g.member_count; ++m) members.push_back(m);
    std::sort(members.begin(), members.end(),
              [&](auto a, auto b) { return place[groups.members[a]] < place[groups.members[b]]; });
    const double length = glm::length(DVec3(g.axis_s));
    for (const std::uint32_t m : members)
      codes.push_back({gridCode(groups.s[m] * length, g.s_min * length, step), gridCode(groups.t[m], g.t_min, step)});
  }
  return codedBits(codes);
}

std::vector<Vec3> positionsOf(const std::vector<std::uint32_t>& vertices, std::span<const Vec3> positions) {
  std::vector<Vec3> found;
  for (const std::uint32_t v : vertices) found.push_back(positions[v]);
  return found;
}

// The order of members within each group as steps between their places, bytes with 7 bits of number each.
double orderBits(const VertexGroups& groups, std::span<const std::uint32_t> place) {
  double bits = 0.0;
  std::vector<std::uint32_t> places;
  for (const VertexGroup& g : groups.groups) {
    places.assign(1, 0);
    for (std::uint32_t m = g.first_member; m < g.first_member + g.member_count; ++m)
      places.push_back(place[groups.members[m]]);
    std::sort(places.begin(), places.end());
    for (std::size_t i = 1; i < places.size(); ++i)
      bits += 8.0 * std::max(1.0, std::ceil(std::bit_width(places[i] - places[i - 1]) / 7.0));
  }
  return bits;
}

}  // namespace

CompressionFigures measureCompression(const mesh::Mesh& mesh, const VertexGroups& groups, int bits) {
  assert(bits >= 1 && bits <= 16);
  assert(mesh.vertexCount() == groups.state.size());
  CompressionFigures figures;
  figures.bits = bits;
  figures.vertices = groups.stats.vertices;
  if (figures.vertices == 0) return figures;
  const std::vector<std::uint32_t> place = placesOf(mesh);
  const auto all = inOrder(groups, place, [](std::uint32_t) { return true; });
  const auto retained =
      inOrder(groups, place, [&](std::uint32_t v) { return groups.state[v] != VertexState::kGrouped; });
  Box3 box;
  for (const std::uint32_t v : all) box.extend(mesh.positions[v]);
  const double step = double(box.longestEdge()) / (std::ldexp(1.0, bits) - 1.0);
  const double per_vertex = 1.0 / figures.vertices;

  figures.plain = 96.0;
  figures.plain_quantised = 3.0 * bits;
  figures.coded = per_vertex * codedPositions(positionsOf(all, mesh.positions), box.lo, step);
  const double parameters = groups.kind == GroupKind::kPlane ? 2.0 : 1.0;
  figures.grouped_parameters = per_vertex * parameters * bits * static_cast<double>(groups.members.size());
  std::size_t kept_bases = 0;
  for (const VertexGroup& g : groups.groups)
    kept_bases += (g.origin == kNoIndex) + (g.kind == GroupKind::kLine && g.end == kNoIndex);
  const double records = kRecordBits * static_cast<double>(groups.groups.size()) + frameBits(groups);
  const double positions = 3.0 * bits * static_cast<double>(retained.size() + kept_bases);
  figures.grouped_retained = per_vertex * (positions + records);
  figures.grouped_order = per_vertex * orderBits(groups, place);
  figures.grouped_coded = per_vertex * (codedParameters(groups, place, step) +
                                        codedPositions(positionsOf(retained, mesh.positions), box.lo, step) +
                                        3.0 * bits * static_cast<double>(kept_bases) + records);
  return figures;
}

}  // namespace sheaf::grouping
