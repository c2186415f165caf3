#include "mesh/weld.h"

#include <bit>
#include <cassert>
#include <utility>

namespace sheaf::mesh {
namespace {

std::uint64_t mixIn(std::uint64_t hash, float value) {
  // Adding 0 turns -0 into 0, which compares equal and must hash equal.
  hash ^= std::bit_cast<std::uint32_t>(value + 0.0F);
  hash *= 0x9E3779B97F4A7C15U;
  return hash ^ (hash >> 29);
}

template <int N>
std::uint64_t mixIn(std::uint64_t hash, const std::vector<glm::vec<N, float>>& values, std::size_t i) {
  if (values.empty()) return hash;
  for (int k = 0; k < N; ++k) hash = mixIn(hash, values[i][k]);
  return hash;
}

std::uint64_t hashOf(const Mesh& mesh, std::size_t v) {
  std::uint64_t hash = mixIn(0, mesh.positions, v);
  hash = mixIn(hash, mesh.normals, v);
  hash = mixIn(hash, mesh.texcoords, v);
  hash = mixIn(hash, mesh.colors, v);
  return hash * 0x9E3779B97F4A7C15U;
}

bool equalVertices(const Mesh& mesh, std::size_t a, std::size_t b) {
  const auto equal = [a, b](const auto& values) { return values.empty() || values[a] == values[b]; };
  return equal(mesh.positions) && equal(mesh.normals) && equal(mesh.texcoords) && equal(mesh.colors);
}

void moveVertex(Mesh& mesh, std::size_t from, std::size_t to) {
  const auto move = [from, to](auto& values) {
    if (!values.empty()) values[to] = values[from];
  };
  move(mesh.positions);
  move(mesh.normals);
  move(mesh.texcoords);
  move(mesh.colors);
}

void resizeVertices(Mesh& mesh, std::size_t count) {
  const auto resize = [count](auto& values) {
    if (values.empty()) return;
    values.resize(count);
    values.shrink_to_fit();
  };
  resize(mesh.positions);
  resize(mesh.normals);
  resize(mesh.texcoords);
  resize(mesh.colors);
}

// Open addressing over the vertices that stay. It grows with them, so that it is small where most vertices vanish.
class VertexTable {
 public:
  explicit VertexTable(const Mesh& mesh) : mesh_(mesh), slots_(std::size_t{1} << 10, kEmpty) {}

  // The entry equal to `candidate`, or `as` after entering that. mesh[as] must be the candidate when looked at later.
  std::uint32_t findOrAdd(std::size_t candidate, std::uint32_t as) {
    if (2 * used_ >= slots_.size()) grow();
    std::size_t slot = slotOf(candidate);
    for (; slots_[slot] != kEmpty; slot = (slot + 1) & (slots_.size() - 1))
      if (equalVertices(mesh_, slots_[slot], candidate)) return slots_[slot];
    slots_[slot] = as;
    ++used_;
    return as;
  }

 private:
  static constexpr std::uint32_t kEmpty = 0xFFFFFFFFU;

  std::size_t slotOf(std::size_t v) const {
    return static_cast<std::size_t>(hashOf(mesh_, v) >> (64 - std::countr_zero(slots_.size())));
  }

  void grow() {
    const std::vector<std::uint32_t> old = std::exchange(slots_, std::vector<std::uint32_t>(2 * slots_.size(), kEmpty));
    for (const std::uint32_t v : old) {
      if (v == kEmpty) continue;
      std::size_t slot = slotOf(v);
      while (slots_[slot] != kEmpty) slot = (slot + 1) & (slots_.size() - 1);
      slots_[slot] = v;
    }
  }

  const Mesh& mesh_;
  std::vector<std::uint32_t> slots_;
  std::size_t used_ = 0;
};

}  // namespace

std::size_t weldVertices(Mesh& mesh) {
  assertValid(mesh);
  const std::size_t before = mesh.vertexCount();
  std::vector<std::uint32_t> new_index(before);
  std::uint32_t kept = 0;
  {
    VertexTable table(mesh);
    for (std::size_t v = 0; v < before; ++v) {
      new_index[v] = table.findOrAdd(v, kept);
      if (new_index[v] == kept) moveVertex(mesh, v, kept++);
    }
  }
  if (kept == before) return 0;
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t) v = new_index[v];
  std::vector<std::uint32_t>().swap(new_index);
  resizeVertices(mesh, kept);
  return before - kept;
}

std::vector<std::uint32_t> firstAtSamePlace(std::vector<Vec3> positions) {
  Mesh mesh;
  mesh.positions = std::move(positions);
  std::vector<std::uint32_t> first(mesh.vertexCount());
  VertexTable table(mesh);
  for (std::uint32_t v = 0; v < first.size(); ++v) first[v] = table.findOrAdd(v, v);
  return first;
}

Mesh surfaceOf(Mesh mesh) {
  mesh.normals = {};
  mesh.texcoords = {};
  mesh.colors = {};
  weldVertices(mesh);
  constexpr std::uint32_t kUnused = 0xFFFFFFFFU;
  std::vector<std::uint32_t> new_index(mesh.vertexCount(), kUnused);
  std::vector<Vec3> positions;
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t) {
      if (new_index[v] == kUnused) {
        new_index[v] = static_cast<std::uint32_t>(positions.size());
        positions.push_back(mesh.positions[v]);
      }
      v = new_index[v];
    }
  mesh.positions = std::move(positions);
  return mesh;
}

std::size_t dropUnusableTriangles(Mesh& mesh) {
  assertValid(mesh);
  return std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return !(isFinite(mesh.positions[t[0]]) && isFinite(mesh.positions[t[1]]) && isFinite(mesh.positions[t[2]]));
  });
}

}  // namespace sheaf::mesh
