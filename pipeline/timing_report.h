// pipeline/timing_report: where the time of a picture went, stage by stage, with the amount of work beside every time.
// The report is data; the texts made from it are returned, never printed.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/stage_timer.h"
#include "pipeline/counters.h"
#include "pipeline/renderer.h"

namespace sheaf::pipeline {

/// A stretch of work outside the frame: import, prepare, encode. Nanoseconds of nowNs().
struct PhaseTime {
  std::int64_t begin_ns = 0;
  std::int64_t end_ns = 0;
  std::int64_t cpu_ns = 0;  ///< of all threads of the process in that time

  std::int64_t wallNs() const { return end_ns - begin_ns; }
};

/// CPU time of all threads of the process so far, nanoseconds.
std::int64_t processCpuNs();

/// Runs `work` and says how long it took.
template <typename Work>
PhaseTime timePhase(const Work& work) {
  PhaseTime phase;
  const std::int64_t cpu_before_ns = processCpuNs();
  phase.begin_ns = nowNs();
  work();
  phase.end_ns = nowNs();
  phase.cpu_ns = processCpuNs() - cpu_before_ns;
  return phase;
}

/// What is kept of one Frame.
struct FrameTimes {
  std::int64_t begin_ns = 0;
  std::int64_t wall_ns = 0;
  StageTimes cpu;
  StageTimes wall;
  Counters counters;
  std::vector<StageSpan> spans;  ///< empty unless recorded
};

/// Everything that was measured. The frames show the same picture, so that they differ in nothing but time.
struct RunTimes {
  std::int64_t begin_ns = 0;  ///< of the whole run
  std::int64_t end_ns = 0;
  PhaseTime import;
  PhaseTime prepare;
  PhaseTime encode;                ///< zero when nothing was written
  std::vector<FrameTimes> frames;  ///< at least one
  std::uint64_t pixels = 0;        ///< of the picture

  /// Takes over the frame's times and spans; begin_ns = nowNs() before it was drawn.
  void addFrame(std::int64_t begin_ns, const Frame& frame);
};

/// Under which circumstances.
struct RunContext {
  std::string input;
  int width = 0;
  int height = 0;
  int threads = 0;
  std::string simd_target;  ///< "AVX2"
  std::string build;        ///< version, compiler, kind of build
  std::string revision;     ///< of the sources
  std::string flags;        ///< of the compiler
  std::string cpu;          ///< model name
};

/// Milliseconds over the frames.
struct Spread {
  double median = 0.0;
  double min = 0.0;
  double max = 0.0;
};

struct StageRow {
  std::string name;
  Spread wall_ms;      ///< of parallel phases: the phase's time on the clock, shared out by the stages' cpu time
  Spread cpu_ms;       ///< summed over threads
  double share = 0.0;  ///< of total_ms, by the median of wall_ms
  std::string item;    ///< what is counted: "vertices"
  std::uint64_t items = 0;
  double items_per_s = 0.0;  ///< by the median of wall_ms; 0 when no time was measured
};

struct TimingReport {
  RunContext context;
  std::vector<StageRow> stages;  ///< import, prepare, cull, transform, clip, setup+bin, raster, shade, encode
  double other_ms = 0.0;         ///< wall time of one picture that belongs to none of the stages
  double total_ms = 0.0;         ///< wall: the medians of the stages and other_ms, which is their sum
  double total_cpu_ms = 0.0;     ///< the medians of the stages
  int frames = 0;
  Spread frame_ms;  ///< wall time of Renderer::render()
  Counters counters;
};

TimingReport makeTimingReport(const RunTimes& run, RunContext context);

/// `1,234,567`, as the tables have whole numbers.
std::string withCommas(std::uint64_t n);

/// An aligned table for people, ending in a newline.
std::string formatTable(const TimingReport& report);

/// As JSON objects; times in milliseconds.
std::string toJson(const RunContext& context);
std::string toJson(const TimingReport& report);

/// Chrome trace event format, which Perfetto opens: a track for the main thread with import, prepare, each frame and
/// encode, and a track per worker with the recorded spans. Times in microseconds from the run's begin.
std::string toTraceJson(const RunTimes& run, const RunContext& context);

}  // namespace sheaf::pipeline
