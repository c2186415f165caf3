#include "cli/saved_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string_view>
#include <system_error>
#include <vector>

#include "cli/group_report.h"
#include "core/error.h"
#include "core/file.h"
#include "grouping/clusters_file.h"
#include "grouping/groups_file.h"

namespace sheaf::cli {
namespace {

using Json = nlohmann::ordered_json;
using grouping::FaceClusters;
using grouping::VertexGroups;

constexpr std::size_t kRootsShown = 8;

std::optional<SavedKind> kindOfBytes(std::string_view bytes) {
  if (bytes.starts_with(grouping::kGroupsFileMagic)) return SavedKind::kVertexGroups;
  if (bytes.starts_with(grouping::kClustersFileMagic)) return SavedKind::kFaceClusters;
  return std::nullopt;
}

/// Of a regular file. Nothing is taken from a pipe, where it would be missing afterwards.
std::string firstBytes(const std::string& path) {
  std::error_code ec;
  if (!std::filesystem::is_regular_file(path, ec)) return {};
  std::string bytes(grouping::kGroupsFileMagic.size(), '\0');
  std::ifstream in(path, std::ios::binary);
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  return bytes;
}

SavedKind kindOrRefusal(std::string_view bytes, const std::string& path) {
  if (const std::optional<SavedKind> kind = kindOfBytes(bytes)) return *kind;
  throw Error(ErrorCode::kBadInput,
              fmt::format("{}: is no file that sheaf has saved, neither vertex groups nor face clusters", path));
}

std::string line(std::string_view head, std::string_view text) {
  return fmt::format("{:<18}{}\n", head, text);
}

std::string fileLine(std::string_view kind, std::uint32_t version, std::size_t bytes) {
  return line("saved", fmt::format("{}, version {}, {} bytes, intact", kind, version, bytes));
}

Json fileJson(const std::string& path, std::string_view kind, std::uint32_t version, std::size_t bytes) {
  return {{"name", path}, {"saved", kind}, {"version", version}, {"bytes", bytes}, {"intact", true}};
}

std::string planesText(const VertexGroups& groups) {
  if (groups.kind == grouping::GroupKind::kLine) return groups.segment_only ? "lines, segments" : "lines";
  return fmt::format("planes across {} direction{}", groups.planes.size(), groups.planes.size() == 1 ? "" : "s");
}

std::string groupsText(const VertexGroups& groups, std::size_t bytes) {
  std::string text = fileLine("vertex groups", grouping::kGroupsFileVersion, bytes);
  text += line("mesh", fmt::format("{} joined vertices", groups.state.size()));
  text += line("kind", fmt::format("{}; {}", planesText(groups), metricText(groups)));
  return text + groupFacts(groups);
}

Json groupsJson(const std::string& path, const VertexGroups& groups, std::size_t bytes) {
  Json json = fileJson(path, "vertex groups", grouping::kGroupsFileVersion, bytes);
  json["joined_vertices"] = groups.state.size();
  json["kind"] = groups.kind == grouping::GroupKind::kLine ? "lines" : "planes";
  json.update(groupFactsJson(groups));
  json["warnings"] = groups.warnings;
  return json;
}

/// Longest way from a root down to a face.
std::uint32_t depthOf(const FaceClusters& clusters) {
  std::vector<std::uint32_t> depth(clusters.nodeCount(), 0);
  std::uint32_t most = 0;
  for (std::uint32_t node = clusters.nodeCount(); node-- > 0;) {  // parents are higher than their parts
    if (clusters.parent[node] != grouping::kNoIndex) depth[node] = depth[clusters.parent[node]] + 1;
    most = std::max(most, depth[node]);
  }
  return most;
}

/// Of the components that have more than one face, the costliest first.
std::vector<float> rootCosts(const FaceClusters& clusters) {
  std::vector<float> costs;
  for (const std::uint32_t root : clusters.roots)
    if (!clusters.isFace(root)) costs.push_back(clusters.cost[root - clusters.faceCount()]);
  std::ranges::sort(costs, std::greater<>());
  return costs;
}

std::string clustersText(const FaceClusters& clusters, std::size_t bytes) {
  std::string text = fileLine("face cluster hierarchy", grouping::kClustersFileVersion, bytes);
  text += line("faces", fmt::format("{}", clusters.faceCount()));
  text += line("clusters", fmt::format("{} of more than one face, {} of them with a box", clusters.children.size(),
                                       clusters.shapes.size()));
  text += line("components", fmt::format("{}", clusters.roots.size()));
  text += line("depth", fmt::format("{}", depthOf(clusters)));
  const std::vector<float> costs = rootCosts(clusters);
  if (costs.empty()) return text;
  const auto shown = std::span(costs).first(std::min(costs.size(), kRootsShown));
  return text + line("root costs", fmt::format("{:.4g}{}", fmt::join(shown, ", "),
                                               costs.size() > kRootsShown ? ", and lower ones" : ""));
}

Json clustersJson(const std::string& path, const FaceClusters& clusters, std::size_t bytes) {
  Json json = fileJson(path, "face cluster hierarchy", grouping::kClustersFileVersion, bytes);
  json["faces"] = clusters.faceCount();
  json["clusters"] = clusters.children.size();
  json["clusters_with_box"] = clusters.shapes.size();
  json["components"] = clusters.roots.size();
  json["depth"] = depthOf(clusters);
  json["root_costs"] = rootCosts(clusters);
  return json;
}

}  // namespace

bool isSavedFile(const std::string& path) {
  return path.ends_with(".sheaf") || kindOfBytes(firstBytes(path)).has_value();
}

SavedKind savedKindOf(const std::string& path) {
  std::error_code ec;
  if (std::filesystem::is_other(path, ec))
    throw Error(ErrorCode::kBadInput, fmt::format("{}: is not a regular file, and has to be read twice", path));
  const std::string bytes = firstBytes(path);
  return kindOrRefusal(bytes.empty() ? readFile(path, false) : bytes, path);  // readFile() says what is wrong
}

void refuseAsScene(const std::string& input) {
  const std::optional<SavedKind> kind = kindOfBytes(firstBytes(input));
  if (!kind) return;
  throw Error(ErrorCode::kUsage,
              fmt::format("{} holds {}: give the mesh, and this with --from (see sheaf info {})", input,
                          *kind == SavedKind::kVertexGroups ? "vertex groups" : "face clusters", input));
}

std::string savedFileText(const std::string& path) {
  const std::string bytes = readFile(path, false);
  return line("name", path) + (kindOrRefusal(bytes, path) == SavedKind::kVertexGroups
                                   ? groupsText(grouping::decodeGroups(bytes, path), bytes.size())
                                   : clustersText(grouping::decodeClusters(bytes, path), bytes.size()));
}

std::string savedFileJson(const std::string& path) {
  const std::string bytes = readFile(path, false);
  const Json json = kindOrRefusal(bytes, path) == SavedKind::kVertexGroups
                        ? groupsJson(path, grouping::decodeGroups(bytes, path), bytes.size())
                        : clustersJson(path, grouping::decodeClusters(bytes, path), bytes.size());
  // Names need not be UTF-8.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace sheaf::cli
