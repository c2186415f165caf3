// core/stage_timer: where the time of a frame goes. Each worker owns a StageClock and says which stage it enters; the
// clocks are added up afterwards. The report is data; nothing here prints.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <string_view>
#include <vector>

namespace sheaf {

enum class Stage : std::uint8_t { kImport, kPrepare, kCull, kTransform, kClip, kSetupBin, kRaster, kShade, kEncode };
inline constexpr int kStageCount = 9;
inline constexpr std::array<std::string_view, kStageCount> kStageNames = {
    "import", "prepare", "cull", "transform", "clip", "setup+bin", "raster", "shade", "encode"};

/// Nanoseconds of the monotonic clock.
inline std::int64_t nowNs() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// One stretch of one stage on one worker, for traces.
struct StageSpan {
  Stage stage;
  std::int32_t worker;
  std::int64_t begin_ns;
  std::int64_t end_ns;
};

/// Nanoseconds by stage.
struct StageTimes {
  std::array<std::int64_t, kStageCount> ns{};

  std::int64_t& operator[](Stage s) { return ns[static_cast<std::size_t>(s)]; }
  std::int64_t operator[](Stage s) const { return ns[static_cast<std::size_t>(s)]; }
  StageTimes& operator+=(const StageTimes& other) {
    for (std::size_t i = 0; i < ns.size(); ++i) ns[i] += other.ns[i];
    return *this;
  }
};

/// A worker's stop watch. begin(a), then(b), then(c), end(): each stretch is added to the stage that it was opened
/// with, for one reading of the clock per call. Used by one thread at a time.
class StageClock {
 public:
  void reset(int worker, bool record_spans) {
    worker_ = worker;
    record_spans_ = record_spans;
    times_ = {};
    spans_.clear();
  }
  void begin(Stage stage) {
    current_ = stage;
    since_ns_ = nowNs();
  }
  void then(Stage stage) {
    close(nowNs());
    current_ = stage;
  }
  void end() { close(nowNs()); }

  const StageTimes& times() const { return times_; }
  const std::vector<StageSpan>& spans() const { return spans_; }

 private:
  void close(std::int64_t now_ns) {
    times_[current_] += now_ns - since_ns_;
    if (record_spans_) spans_.push_back({current_, worker_, since_ns_, now_ns});
    since_ns_ = now_ns;
  }

  StageTimes times_;
  std::vector<StageSpan> spans_;
  std::int64_t since_ns_ = 0;
  std::int32_t worker_ = 0;
  Stage current_ = Stage::kImport;
  bool record_spans_ = false;
};

}  // namespace sheaf
