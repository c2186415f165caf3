// pipeline/baselines: what vertex groups gain in time: three ways to draw the same scene, timed in turns.
//   classic  every vertex of every patch of the original mesh
//   modern   the same mesh, patches outside the view or facing away left out, each tested by itself
//   grouped  the same patches are left out, found by way of the tree over them; of the others vertices are transformed
//            and clipped by groups
// All three run through the same raster and the same shading, with the same vectors and threads.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/prepare.h"
#include "pipeline/renderer.h"
#include "pipeline/timing_report.h"

namespace sheaf::pipeline {

enum class Baseline : std::uint8_t { kClassic, kModern, kGrouped };
inline constexpr std::size_t kBaselineCount = 3;
inline constexpr std::array<std::string_view, kBaselineCount> kBaselineNames = {"classic", "modern", "grouped"};

template <typename Value>
using PerBaseline = std::array<Value, kBaselineCount>;

/// The frames along one row of cameras.
struct BaselineRun {
  std::vector<PerBaseline<FrameTimes>> frames;
  std::uint64_t differing_frames = 0;  ///< where culling of patches changed the picture, which it must not
  Image8 picture;                      ///< grouped, from the camera in the middle of the row
};

/// The scene prepared in both forms, and a renderer.
class BaselineBench {
 public:
  /// grouping  use_groups does not count
  /// settings  culling does not count
  /// progress  as for prepareScene()
  BaselineBench(const scenes::Scene& scene, GroupingOptions grouping, RenderSettings settings, TaskPool& pool,
                const grouping::Progress& progress = {});

  const PreparedScene& original() const { return original_; }
  const PreparedScene& grouped() const { return grouped_; }
  std::uint64_t vertexCount() const { return vertex_count_; }  ///< of the original, over all instances and patches

  /// Draws `frames` frames, frame f from camera f modulo their number, each in all three ways before the next.
  /// Before each that is timed stands one that is not, drawn the same way, so that each finds its data in the caches as
  /// it would if there were no other. Near and far of the cameras are set. `done` is called after each frame with the
  /// share of frames that are done. Throws what Renderer::render() throws.
  BaselineRun run(std::span<const scenes::Camera> cameras, int frames, const std::function<void(double)>& done);

 private:
  PreparedScene original_;
  PreparedScene grouped_;
  RenderSettings settings_;
  Renderer renderer_;
  PerBaseline<Frame> drawn_;
  std::uint64_t vertex_count_ = 0;
};

/// Over the frames.
struct Quartiles {
  double min = 0.0;
  double lower = 0.0;
  double median = 0.0;
  double upper = 0.0;
  double max = 0.0;
  double mean = 0.0;  ///< means of parts add up to the mean of the whole
};

/// Between two values they are interpolated. All zero without values.
Quartiles quartilesOf(std::vector<double> values);

/// A stage, or several together.
struct BaselineRow {
  std::string name;
  PerBaseline<Quartiles> wall_ms;     ///< see Frame::wall
  PerBaseline<Quartiles> cpu_ms;      ///< summed over threads; of `other` and `frame` all zero: only stages know it
  std::string item;                   ///< what is counted: "vertices"; may be empty
  PerBaseline<double> items{};        ///< in a frame, the mean
  PerBaseline<double> ns_per_item{};  ///< wall; the median over the frames that have any, else 0
  /// How many times as fast grouped drawing is as the other, frame by frame. 0 where times are too short to measure.
  PerBaseline<Quartiles> speedup;
};

/// cull, transform, clip, setup+bin, raster, shade, other, frame, and as sums: geometry (the first four),
/// transform+clip.
std::vector<BaselineRow> summarize(const BaselineRun& run, std::uint64_t vertex_count);

/// The mean over the frames, rounded.
PerBaseline<Counters> meanCounters(const BaselineRun& run);

/// Wall time of a row's stages in a frame, milliseconds: the values that summarize() is made from. `row` is one of its
/// names.
double rowMs(const FrameTimes& frame, std::string_view row);

}  // namespace sheaf::pipeline
