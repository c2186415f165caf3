#include "grouping/clusters_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "core/file.h"
#include "grouping/byte_stream.h"
#include "grouping/sealed_file.h"

namespace sheaf::grouping {
namespace {

constexpr FileKind kFileKind = {kClustersFileMagic, kClustersFileVersion, "face clusters"};

// Padding would write bytes of no meaning, and other ones each time.
static_assert(sizeof(ClusterShape) == 27 * sizeof(float));

std::uint32_t checksumOf(const mesh::Mesh& mesh) {
  constexpr std::size_t kFacesAtATime = 512;
  std::array<std::array<Vec3, 3>, kFacesAtATime> corners;
  uLong crc = crc32(0, nullptr, 0);
  for (std::size_t begin = 0; begin < mesh.triangleCount(); begin += kFacesAtATime) {
    const std::size_t count = std::min(kFacesAtATime, mesh.triangleCount() - begin);
    for (std::size_t f = 0; f < count; ++f)
      for (std::size_t k = 0; k < 3; ++k)  // adding 0 turns -0 into 0, which is the same place
        corners[f][k] = mesh.positions[mesh.triangles[begin + f][k]] + 0.0F;
    crc = crc32(crc, reinterpret_cast<const Bytef*>(corners.data()), static_cast<uInt>(count * sizeof corners[0]));
  }
  return static_cast<std::uint32_t>(crc);
}

Box3 finiteBounds(const mesh::Mesh& mesh) {
  Box3 box;
  for (const Vec3& p : mesh.positions)
    if (isFinite(p)) box.extend(p);
  return box;
}

/// A shape reaches no further than its mesh. Twice that leaves room for rounding, and keeps off what could overflow.
bool isAround(const ClusterShape& shape, const Box3& box) {
  if (shape == ClusterShape{}) return true;  // of faces that do not count
  const DVec3 middle = 0.5 * (DVec3(box.lo) + DVec3(box.hi)), size = DVec3(box.hi) - DVec3(box.lo);
  const double reach = 2.0 * glm::length(size) + 1e-3 * glm::length(middle);
  const DVec3 farthest = glm::max(glm::abs(DVec3(shape.lo)), glm::abs(DVec3(shape.hi)));
  return glm::distance(DVec3(shape.center), middle) <= reach && std::max({farthest.x, farthest.y, farthest.z}) <= reach;
}

std::string encodeContent(const FaceClusters& clusters, const mesh::Mesh& mesh) {
  std::vector<std::uint32_t> place(clusters.nodeCount(), kNoIndex);
  for (std::uint32_t i = 0; i < clusters.children.size(); ++i)
    for (std::uint32_t side = 0; side < 2; ++side) place[clusters.children[i][side]] = 2 * i + side;
  ByteWriter out;
  out.put(clusters.faceCount());
  out.put(static_cast<std::uint32_t>(clusters.children.size()));
  out.put(checksumOf(mesh));
  out.putAll(std::span<const std::uint32_t>(place));
  out.putAll(std::span<const float>(clusters.cost));
  for (const std::uint32_t index : clusters.shape_index) out.putBits(index != kNoIndex ? 1U : 0U, 1);
  out.alignBits();
  out.putAll(std::span<const ClusterShape>(clusters.shapes));
  return out.take();
}

// Reads the content. Every refusal goes through fail(); counts are held against the bytes that are left before any
// memory is taken for them.
class Decoder {
 public:
  // mesh  nullptr: not held against one
  Decoder(std::string_view content, const mesh::Mesh* mesh, std::string_view name)
      : in_(content), mesh_(mesh), name_(name) {}

  FaceClusters decode() {
    faces_ = in_.get<std::uint32_t>();
    merges_ = in_.get<std::uint32_t>();
    const auto checksum = in_.get<std::uint32_t>();
    if (std::uint64_t{faces_} + 2 * std::uint64_t{merges_} > in_.left() / 4) fail("more faces than bytes");
    if (mesh_ != nullptr) checkMesh(checksum);
    std::vector<std::array<std::uint32_t, 2>> children = getChildren();
    std::vector<float> cost(merges_);
    in_.getAll(std::span(cost));
    for (const float c : cost)
      if (std::isnan(c)) fail("a cost is no number");
    FaceClusters out = hierarchyOf(faces_, std::move(children), std::move(cost));
    getShapes(out);
    if (in_.failed()) fail("ends too early");
    if (in_.left() > 0) fail(fmt::format("{} bytes too many", in_.left()));
    return out;
  }

 private:
  [[noreturn]] void fail(std::string_view reason) const {
    throw Error(ErrorCode::kBadInput, fmt::format("{}: damaged face clusters: {}", name_, reason));
  }

  void checkMesh(std::uint32_t checksum) const {
    const auto refuse = [&](std::string_view reason) {
      throw Error(ErrorCode::kBadInput, fmt::format("{}: belongs to another mesh: {}", name_, reason));
    };
    if (faces_ != mesh_->triangleCount())
      refuse(fmt::format("its clusters are of {} faces, the mesh has {}", faces_, mesh_->triangleCount()));
    if (checksum != checksumOf(*mesh_)) refuse("as many faces, but other corners");
  }

  std::vector<std::array<std::uint32_t, 2>> getChildren() {
    std::vector<std::uint32_t> place(std::size_t{faces_} + merges_);
    in_.getAll(std::span(place));
    std::vector<std::array<std::uint32_t, 2>> children(merges_, {kNoIndex, kNoIndex});
    for (std::uint32_t node = 0; node < place.size(); ++node) {
      if (place[node] == kNoIndex) continue;
      const std::uint32_t merge = place[node] / 2, side = place[node] % 2;
      if (merge >= merges_) fail(fmt::format("node {} is in merge {} of {}", node, merge, merges_));
      if (children[merge][side] != kNoIndex) fail(fmt::format("merge {} has more than two parts", merge));
      children[merge][side] = node;
    }
    // A part that is missing is kNoIndex and so no node below.
    if (const std::string reason = findBrokenMerge(faces_, children); !reason.empty()) fail(reason);
    return children;
  }

  void getShapes(FaceClusters& out) {
    std::uint32_t count = 0;
    out.shape_index.assign(merges_, kNoIndex);
    for (std::uint32_t& index : out.shape_index)
      if (in_.getBits(1) != 0) index = count++;
    in_.alignBits();
    if (count > in_.left() / sizeof(ClusterShape)) fail("more shapes than bytes");
    out.shapes.resize(count);
    in_.getAll(std::span(out.shapes));
    for (std::uint32_t i = 0; i < count; ++i)
      if (!isSound(out.shapes[i])) fail(fmt::format("shape {} is not possible", i));
    if (mesh_ != nullptr) checkPlaces(out.shapes);
    // The bits stand in the order of the merges, the shapes depth first.
    std::uint32_t next = 0;
    walkDown(out, [&](std::uint32_t node) {
      if (out.storedShape(node) != nullptr) out.shape_index[node - faces_] = next++;
      return !out.isFace(node);
    });
  }

  void checkPlaces(std::span<const ClusterShape> shapes) const {
    const Box3 box = finiteBounds(*mesh_);
    for (std::size_t i = 0; i < shapes.size(); ++i)
      if (!isAround(shapes[i], box)) fail(fmt::format("shape {} is not where the mesh is", i));
  }

  ByteReader in_;
  const mesh::Mesh* mesh_;
  std::string_view name_;
  std::uint32_t faces_ = 0;
  std::uint32_t merges_ = 0;
};

}  // namespace

std::string encodeClusters(const FaceClusters& clusters, const mesh::Mesh& mesh) {
  assert(clusters.shape_index.size() == clusters.children.size());
  assert(clusters.faceCount() == mesh.triangleCount());
  return sealed(kFileKind, encodeContent(clusters, mesh));
}

FaceClusters decodeClusters(std::string_view bytes, const mesh::Mesh& mesh, std::string_view name) {
  return Decoder(unsealed(kFileKind, bytes, name), &mesh, name).decode();
}

FaceClusters decodeClusters(std::string_view bytes, std::string_view name) {
  return Decoder(unsealed(kFileKind, bytes, name), nullptr, name).decode();
}

void saveClusters(const std::filesystem::path& path, const FaceClusters& clusters, const mesh::Mesh& mesh) {
  writeFile(path, encodeClusters(clusters, mesh));
}

FaceClusters loadClusters(const std::filesystem::path& path, const mesh::Mesh& mesh) {
  return decodeClusters(readFile(path, false), mesh, path.string());
}

}  // namespace sheaf::grouping
