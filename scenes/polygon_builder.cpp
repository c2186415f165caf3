#include "scenes/polygon_builder.h"

#include <fmt/format.h>

#include <algorithm>

#include "mesh/polygon.h"

namespace sheaf::scenes {

std::string badIndexText(std::int64_t index, std::size_t vertex_count) {
  return fmt::format("refers to vertex {} (counted from 0), the mesh has {}", index, vertex_count);
}

std::size_t PolygonBuilder::firstBadCorner(std::span<const std::int64_t> corners) const {
  const auto count = static_cast<std::int64_t>(mesh_.positions.size());
  const auto bad = std::find_if(corners.begin(), corners.end(), [&](std::int64_t v) { return v < 0 || v >= count; });
  return static_cast<std::size_t>(bad - corners.begin());
}

void PolygonBuilder::addFace(std::span<const std::int64_t> corners) {
  if (corners.size() < 3) {
    ++too_few_corners_;
    return;
  }
  const auto vertex = [&](std::size_t corner) { return static_cast<std::uint32_t>(corners[corner]); };
  if (corners.size() == 3) {
    mesh_.triangles.push_back({vertex(0), vertex(1), vertex(2)});
    return;
  }
  corner_positions_.clear();
  for (const std::int64_t v : corners) corner_positions_.push_back(mesh_.positions[static_cast<std::size_t>(v)]);
  corner_triangles_.clear();
  if (!mesh::triangulatePolygon(corner_positions_, corner_triangles_)) ++tangled_;
  for (const mesh::Triangle& t : corner_triangles_)
    mesh_.triangles.push_back({vertex(t[0]), vertex(t[1]), vertex(t[2])});
}

void PolygonBuilder::addStrip(std::span<const std::int64_t> corners) {
  for (std::size_t i = 0; i + 2 < corners.size(); ++i) {
    const auto a = static_cast<std::uint32_t>(corners[i]);
    const auto b = static_cast<std::uint32_t>(corners[i + 1 + i % 2]);
    const auto c = static_cast<std::uint32_t>(corners[i + 2 - i % 2]);
    if (a != b && b != c && c != a) mesh_.triangles.push_back({a, b, c});
  }
}

void PolygonBuilder::reportTo(std::vector<std::string>& warnings, std::string_view name) const {
  if (too_few_corners_ > 0)
    warnings.push_back(fmt::format("{}: {} faces with fewer than 3 corners left out", name, too_few_corners_));
  if (tangled_ > 0)
    warnings.push_back(
        fmt::format("{}: {} polygons that cross themselves or are flat lines cut as fans", name, tangled_));
}

}  // namespace sheaf::scenes
