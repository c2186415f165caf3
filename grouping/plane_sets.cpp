#include "grouping/plane_sets.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>
#include <string>
#include <string_view>

#include "core/error.h"
#include "core/file.h"

namespace sheaf::grouping {
namespace {

// Neither 0 nor so far off that it or its square could not be represented.
bool isUsableLength(double length) {
  return length > 1e-150 && length < 1e150;
}

// axis_s is the coordinate axis after the one that the normal is most along, made orthogonal to the normal: at least 45
// degrees lie between the two. For x, y and z themselves this gives (y, z), (z, x) and (x, y).
PlaneFrame frameOf(const DVec3& normal) {
  int most = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(normal[k]) > std::abs(normal[most])) most = k;
  DVec3 next(0.0);
  next[(most + 1) % 3] = 1.0;
  const DVec3 axis_s = glm::normalize(next - glm::dot(next, normal) * normal);
  return {Vec3(normal), Vec3(axis_s), Vec3(glm::cross(normal, axis_s))};
}

// The next word of a line, taken off its front.
std::string_view takeWord(std::string_view& line) {
  constexpr std::string_view kBlank = " \t\r";
  line.remove_prefix(std::min(line.find_first_not_of(kBlank), line.size()));
  const std::string_view word = line.substr(0, std::min(line.find_first_of(kBlank), line.size()));
  line.remove_prefix(word.size());
  return word;
}

// The normal in a line; nothing if the line is empty.
std::optional<DVec3> parseNormal(std::string_view line, const auto& fail) {
  line = line.substr(0, line.find('#'));
  DVec3 normal(0.0);
  for (int k = 0; k < 3; ++k) {
    const std::string_view word = takeWord(line);
    if (k == 0 && word.empty()) return std::nullopt;
    const auto [end, ec] = std::from_chars(word.data(), word.data() + word.size(), normal[k]);
    if (ec != std::errc() || end != word.data() + word.size()) fail("expected three numbers, the normal of a plane");
  }
  if (!takeWord(line).empty()) fail("expected three numbers, found more");
  const double length = glm::length(normal);
  if (!isUsableLength(length)) fail("the normal has no direction");
  return normal;
}

}  // namespace

std::vector<PlaneFrame> axisPlanes() {
  return planesFromNormals(std::vector<DVec3>{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
}

std::vector<PlaneFrame> dodecahedronPlanes() {
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  return planesFromNormals(std::vector<DVec3>{{0, 1, g}, {0, 1, -g}, {1, g, 0}, {1, -g, 0}, {g, 0, 1}, {g, 0, -1}});
}

std::vector<PlaneFrame> axisAndDodecahedronPlanes() {
  std::vector<PlaneFrame> planes = axisPlanes();
  for (const PlaneFrame& frame : dodecahedronPlanes()) planes.push_back(frame);
  return planes;
}

std::vector<PlaneFrame> planesFromNormals(std::span<const DVec3> normals) {
  if (normals.empty()) throw Error(ErrorCode::kBadInput, "plane set: has no planes");
  std::vector<PlaneFrame> planes;
  for (const DVec3& n : normals) {
    const double length = glm::length(n);
    if (!isUsableLength(length))
      throw Error(ErrorCode::kBadInput,
                  fmt::format("plane set: normal {} ({}, {}, {}) has no direction", planes.size() + 1, n.x, n.y, n.z));
    planes.push_back(frameOf(n / length));
  }
  return planes;
}

std::vector<PlaneFrame> loadPlanes(const std::filesystem::path& path) {
  const std::string text = readFile(path);
  std::vector<DVec3> normals;
  int line_number = 0;
  const auto fail = [&](std::string_view reason) {
    throw Error(ErrorCode::kBadInput, fmt::format("{}:{}: {}", path.string(), line_number, reason));
  };
  for (std::string_view rest = text; !rest.empty();) {
    ++line_number;
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    const std::optional<DVec3> normal = parseNormal(line, fail);
    if (!normal) continue;
    if (normals.size() == kMaxFilePlanes) fail(fmt::format("more than {} normals", kMaxFilePlanes));
    normals.push_back(*normal);
  }
  if (normals.empty()) throw Error(ErrorCode::kBadInput, fmt::format("{}: has no normals of planes", path.string()));
  return planesFromNormals(normals);
}

}  // namespace sheaf::grouping
