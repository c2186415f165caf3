#include "grouping/groups_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <optional>

#include "core/error.h"
#include "core/file.h"
#include "grouping/byte_stream.h"
#include "grouping/sealed_file.h"

namespace sheaf::grouping {
namespace {

constexpr FileKind kFileKind = {kGroupsFileMagic, kGroupsFileVersion, "vertex groups"};
constexpr int kMaxParameterBits = 24;

template <typename T>
std::uint32_t addToChecksum(std::uint32_t crc, std::span<const T> values) {
  constexpr std::size_t kAtATime = 1U << 20U;
  for (std::size_t i = 0; i < values.size(); i += kAtATime) {
    const std::span<const T> part = values.subspan(i, std::min(kAtATime, values.size() - i));
    crc = static_cast<std::uint32_t>(
        crc32(crc, reinterpret_cast<const Bytef*>(part.data()), static_cast<uInt>(part.size_bytes())));
  }
  return crc;
}

// The n-bit code of a parameter in [lo, hi], and back. Both ends of the range are kept exactly.
struct Quantiser {
  float lo, hi;
  std::uint32_t most;  // 2^bits - 1

  std::uint32_t code(float value) const {
    if (!(hi > lo)) return 0;
    const double share = (double(value) - double(lo)) / (double(hi) - double(lo));
    return static_cast<std::uint32_t>(std::lround(std::clamp(share, 0.0, 1.0) * most));
  }
  float value(std::uint32_t code) const {
    if (code >= most) return hi;
    return static_cast<float>(double(lo) + (double(hi) - double(lo)) * (double(code) / most));
  }
};

void putStats(ByteWriter& out, const GroupingStats& s) {
  for (const std::uint32_t count :
       {s.vertices, s.free, s.defining, s.grouped, s.flipped_faces, s.collapsed_faces, s.restored_vertices})
    out.put(count);
  for (const double figure : {s.eliminated, s.displacement_max, s.displacement_mean, s.displacement_rms,
                              s.normal_deviation_max_rad, s.normal_deviation_rms_rad, s.search_ms})
    out.put(figure);
}

GroupingStats getStats(ByteReader& in) {
  GroupingStats s;
  for (std::uint32_t* count :
       {&s.vertices, &s.free, &s.defining, &s.grouped, &s.flipped_faces, &s.collapsed_faces, &s.restored_vertices})
    *count = in.get<std::uint32_t>();
  for (double* figure : {&s.eliminated, &s.displacement_max, &s.displacement_mean, &s.displacement_rms,
                         &s.normal_deviation_max_rad, &s.normal_deviation_rms_rad, &s.search_ms})
    *figure = in.get<double>();
  return s;
}

void putParameters(ByteWriter& out, std::span<const float> values, float lo, float hi, int bits) {
  if (bits == 0) {
    for (const float v : values) out.put(v);
    return;
  }
  const Quantiser quantiser{lo, hi, (1U << bits) - 1U};
  out.put(lo);
  out.put(hi);
  for (const float v : values) out.putBits(quantiser.code(v), bits);
  out.alignBits();
}

void getParameters(ByteReader& in, std::span<float> values, int bits) {
  if (bits == 0) {
    for (float& v : values) v = in.get<float>();
    return;
  }
  const auto lo = in.get<float>(), hi = in.get<float>();
  const Quantiser quantiser{lo, hi, (1U << bits) - 1U};
  for (float& v : values) v = quantiser.value(in.getBits(bits));
  in.alignBits();
}

void putGroup(ByteWriter& out, const VertexGroups& groups, const VertexGroup& g, int bits) {
  out.put(g.origin);
  out.put(g.base);
  if (g.kind == GroupKind::kLine) {
    out.put(g.end);
    out.put(g.axis_s);
  } else {
    out.put(g.plane);
  }
  out.putVariable(g.member_count);
  std::uint32_t before = 0;
  for (std::uint32_t m = g.first_member; m < g.first_member + g.member_count; ++m) {
    out.putVariable(groups.members[m] - before);
    before = groups.members[m];
  }
  const auto s = std::span(groups.s).subspan(g.first_member, g.member_count);
  const auto t = std::span(groups.t).subspan(g.first_member, g.member_count);
  putParameters(out, s, g.s_min, g.s_max, bits);
  if (g.kind == GroupKind::kPlane) putParameters(out, t, g.t_min, g.t_max, bits);
}

std::string encodeContent(const VertexGroups& groups, int bits) {
  ByteWriter out;
  for (const std::uint8_t field :
       {static_cast<std::uint8_t>(groups.kind), static_cast<std::uint8_t>(groups.metric),
        static_cast<std::uint8_t>(groups.limit), groups.dimensions, static_cast<std::uint8_t>(groups.segment_only),
        static_cast<std::uint8_t>(groups.interrupted), static_cast<std::uint8_t>(bits)})
    out.put(field);
  out.put(groups.mesh_checksum);
  out.put(groups.epsilon);
  out.put(groups.extent);
  putStats(out, groups.stats);
  out.put(static_cast<std::uint32_t>(groups.warnings.size()));
  for (const std::string& warning : groups.warnings) out.putText(warning);
  out.put(static_cast<std::uint32_t>(groups.planes.size()));
  for (const PlaneFrame& plane : groups.planes) out.put(plane);

  out.put(static_cast<std::uint32_t>(groups.state.size()));
  for (const VertexState state : groups.state) {
    out.putBits(state != VertexState::kUnused ? 1U : 0U, 1);
    out.putBits(state == VertexState::kGrouped ? 1U : 0U, 1);
  }
  out.alignBits();
  for (std::size_t v = 0; v < groups.state.size(); ++v)
    if (groups.state[v] != VertexState::kGrouped) out.put(groups.positions[v]);
  out.put(static_cast<std::uint32_t>(groups.groups.size()));
  for (const VertexGroup& g : groups.groups) putGroup(out, groups, g, bits);
  return out.take();
}

// A right-handed frame of unit axes, as drawing takes it to be: its inverse is its transpose.
bool isOrthonormal(const PlaneFrame& frame) {
  constexpr double kTolerance = 1e-5;
  const DVec3 s(frame.axis_s), t(frame.axis_t), off = glm::cross(s, t) - DVec3(frame.normal);
  for (const double error : {glm::dot(s, s) - 1.0, glm::dot(t, t) - 1.0, glm::dot(s, t), off.x, off.y, off.z})
    if (!(std::abs(error) <= kTolerance)) return false;  // also of no number
  return true;
}

// Reads the content. Every refusal goes through fail(); counts are held against the bytes that are left before any
// memory is taken for them.
class Decoder {
 public:
  Decoder(std::string_view content, std::string_view name) : in_(content), name_(name) {}

  VertexGroups decode() {
    getSettings();
    getVertices();
    const auto group_count = in_.get<std::uint32_t>();
    if (group_count > in_.left()) fail("more groups than bytes");
    for (std::uint32_t g = 0; g < group_count; ++g) getGroup();
    if (in_.failed()) fail("ends too early");
    if (in_.left() > 0) fail(fmt::format("{} bytes too many", in_.left()));
    for (const VertexGroup& g : out_.groups) {
      if (g.origin != kNoIndex) out_.state[g.origin] = VertexState::kDefining;
      if (g.end != kNoIndex) out_.state[g.end] = VertexState::kDefining;
    }
    if (const std::string reason = findInconsistency(out_); !reason.empty()) fail(reason);
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(std::string_view reason) const {
    throw Error(ErrorCode::kBadInput, fmt::format("{}: damaged vertex groups: {}", name_, reason));
  }

  // A byte that stands for one of `count` values.
  std::uint8_t choice(int count, std::string_view what) {
    const auto value = in_.get<std::uint8_t>();
    if (in_.failed()) fail("ends too early");
    if (value >= count) fail(fmt::format("{} {} is none of {}", what, value, count));
    return value;
  }

  void getSettings() {
    out_.kind = static_cast<GroupKind>(choice(2, "kind"));
    out_.metric = static_cast<Metric>(choice(2, "metric"));
    out_.limit = static_cast<Limit>(choice(2, "limit"));
    out_.dimensions = choice(4, "dimension");
    out_.segment_only = choice(2, "segment flag") != 0;
    out_.interrupted = choice(2, "interruption flag") != 0;
    bits_ = choice(kMaxParameterBits + 1, "parameter size");
    out_.mesh_checksum = in_.get<std::uint32_t>();
    out_.epsilon = in_.get<double>();
    out_.extent = in_.get<double>();
    out_.stats = getStats(in_);
    const auto warning_count = in_.get<std::uint32_t>();
    if (warning_count > in_.left()) fail("more warnings than bytes");
    for (std::uint32_t i = 0; i < warning_count; ++i) out_.warnings.push_back(in_.getText());
    const auto plane_count = in_.get<std::uint32_t>();
    if (plane_count > in_.left() / sizeof(PlaneFrame)) fail("more planes than bytes");
    for (std::uint32_t i = 0; i < plane_count; ++i) {
      out_.planes.push_back(in_.get<PlaneFrame>());
      if (!isOrthonormal(out_.planes.back())) fail(fmt::format("plane {} has no orthonormal frame", i));
    }
  }

  void getVertices() {
    const std::size_t count = in_.get<std::uint32_t>();
    if (count > 4 * in_.left()) fail("more vertices than bytes");
    out_.owner.assign(count, kNoIndex);
    out_.positions.assign(count, Vec3(0.0F));
    out_.state.resize(count);
    for (VertexState& state : out_.state) {
      const bool used = in_.getBits(1) != 0, grouped = in_.getBits(1) != 0;
      if (grouped && !used) fail("a vertex that is not used is grouped");
      state = grouped ? VertexState::kGrouped : used ? VertexState::kFree : VertexState::kUnused;
    }
    in_.alignBits();
    for (std::size_t v = 0; v < count; ++v)
      if (out_.state[v] != VertexState::kGrouped) out_.positions[v] = in_.get<Vec3>();
  }

  void getGroup() {
    VertexGroup g;
    g.kind = out_.kind;
    g.origin = vertex();
    g.base = in_.get<Vec3>();
    if (g.kind == GroupKind::kLine) {
      g.end = vertex();
      g.axis_s = in_.get<Vec3>();
      g.s_max = 1.0F;
    } else {
      g.plane = in_.get<std::uint32_t>();
      if (g.plane >= out_.planes.size()) fail(fmt::format("plane {} of {}", g.plane, out_.planes.size()));
      g.axis_s = out_.planes[g.plane].axis_s;
      g.axis_t = out_.planes[g.plane].axis_t;
    }
    g.first_member = static_cast<std::uint32_t>(out_.members.size());
    g.member_count = in_.getVariable();
    if (g.member_count > in_.left()) fail("more members than bytes");
    getMembers(g);
    out_.groups.push_back(g);
  }

  // Any vertex, or kNoIndex.
  std::uint32_t vertex() {
    const auto v = in_.get<std::uint32_t>();
    if (v != kNoIndex && v >= out_.state.size()) fail(fmt::format("vertex {} of {}", v, out_.state.size()));
    return v;
  }

  void getMembers(VertexGroup& g) {
    const auto id = static_cast<std::uint32_t>(out_.groups.size());
    std::uint64_t v = 0;
    for (std::uint32_t m = 0; m < g.member_count; ++m) {
      v += in_.getVariable();
      if (v >= out_.state.size()) fail(fmt::format("member {} of {} vertices", v, out_.state.size()));
      if (out_.owner[v] != kNoIndex) fail(fmt::format("vertex {} is in two groups", v));
      out_.owner[v] = id;
      out_.members.push_back(static_cast<std::uint32_t>(v));
    }
    out_.s.resize(out_.members.size());
    out_.t.resize(out_.members.size());
    getParameters(in_, std::span(out_.s).subspan(g.first_member), bits_);
    if (g.kind == GroupKind::kPlane) getParameters(in_, std::span(out_.t).subspan(g.first_member), bits_);
    for (std::size_t m = g.first_member; m < out_.members.size(); ++m) {
      g.s_min = std::min(g.s_min, out_.s[m]), g.s_max = std::max(g.s_max, out_.s[m]);
      g.t_min = std::min(g.t_min, out_.t[m]), g.t_max = std::max(g.t_max, out_.t[m]);
      Vec3& position = out_.positions[out_.members[m]];
      position = pointOn(g, out_.s[m], out_.t[m]);
      if (!isFinite(position)) fail(fmt::format("member {} lies nowhere", out_.members[m]));
    }
  }

  ByteReader in_;
  std::string_view name_;
  VertexGroups out_;
  int bits_ = 0;
};

}  // namespace

std::uint32_t meshChecksum(const mesh::Mesh& mesh) {
  const std::uint32_t crc = addToChecksum(0, std::span<const Vec3>(mesh.positions));
  return addToChecksum(crc, std::span<const mesh::Triangle>(mesh.triangles));
}

std::string encodeGroups(const VertexGroups& groups, const GroupsFileOptions& options) {
  assert(options.parameter_bits >= 0 && options.parameter_bits <= kMaxParameterBits);
  return sealed(kFileKind, encodeContent(groups, options.parameter_bits));
}

VertexGroups decodeGroups(std::string_view bytes, std::string_view name) {
  return Decoder(unsealed(kFileKind, bytes, name), name).decode();
}

void saveGroups(const std::filesystem::path& path, const VertexGroups& groups, const GroupsFileOptions& options) {
  writeFile(path, encodeGroups(groups, options));
}

VertexGroups loadGroups(const std::filesystem::path& path) {
  return decodeGroups(readFile(path, false), path.string());
}

VertexGroups loadGroups(const std::filesystem::path& path, const mesh::Mesh& mesh) {
  VertexGroups groups = loadGroups(path);
  const auto refuse = [&](std::string_view reason) {
    throw Error(ErrorCode::kBadInput, fmt::format("{}: belongs to another mesh: {}", path.string(), reason));
  };
  if (groups.state.size() != mesh.vertexCount())
    refuse(fmt::format("its groups are of {} vertices, the mesh has {}", groups.state.size(), mesh.vertexCount()));
  if (groups.mesh_checksum != meshChecksum(mesh)) refuse("as many vertices, but at other places or in other faces");
  // The checksum stands in the file, as the places do. Bits, for unused vertices may have no number.
  for (std::size_t v = 0; v < mesh.vertexCount(); ++v)
    if (groups.state[v] != VertexState::kGrouped &&
        std::memcmp(&groups.positions[v], &mesh.positions[v], sizeof(Vec3)) != 0)
      refuse(fmt::format("vertex {} is in no group, but not where the mesh has it", v));
  return groups;
}

}  // namespace sheaf::grouping
