// pipeline/renderer: draws prepared scenes.
#pragma once

#include <memory>
#include <vector>

#include "core/image.h"
#include "core/stage_timer.h"
#include "core/task_pool.h"
#include "pipeline/counters.h"
#include "pipeline/patch_culling.h"
#include "pipeline/prepare.h"
#include "scenes/scene.h"

namespace sheaf::pipeline {

struct RenderSettings {
  int width = 1280;  ///< [1, 16384] pixels
  int height = 720;  ///< [1, 16384] pixels
  Culling culling = Culling::kTree;
  Vec4 background{0.0F, 0.0F, 0.0F, 0.0F};  ///< linear, straight alpha
  bool want_srgb = true;                    ///< fill Frame::color
  bool want_linear = false;                 ///< fill Frame::linear
  bool want_depth = false;                  ///< fill Frame::depth
  bool want_ids = false;                    ///< fill Frame::instance_id and Frame::triangle_id
  bool record_spans = false;                ///< fill Frame::spans
};

/// A drawn picture and how it came about. Images that were not asked for are empty. Reused from frame to frame.
struct Frame {
  Image8 color;          ///< sRGB-coded, straight alpha
  ImageF4 linear;        ///< linear, premultiplied
  ImageF depth;          ///< reversed: 1 at the near plane, 0 at the far plane and where nothing is
  ImageU32 instance_id;  ///< index into Scene::instances, raster::kNoTriangle where nothing is
  ImageU32 triangle_id;  ///< index into the mesh's triangles, raster::kNoTriangle where nothing is
  Counters counters;
  StageTimes cpu;   ///< per stage, summed over the workers
  StageTimes wall;  ///< per stage: the wall time of each parallel phase, shared out by the stages' cpu time in it
  std::int64_t wall_ns = 0;  ///< of the whole call
  std::vector<StageSpan> spans;
};

/// Holds the scratch memory of frames. One frame at a time; frames may differ in scene, camera and size.
class Renderer {
 public:
  explicit Renderer(TaskPool& pool);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// camera    near and far must be set (scenes::fitClipPlanes)
  /// settings  size within the range stated there, which is asserted
  /// frame     overwritten; its memory is used again where sizes allow
  /// Throws Error(kUnsupported) when more triangles are in view than raster::ShadeTriangleArena::kMaxTriangles.
  void render(const PreparedScene& scene, const scenes::Camera& camera, const RenderSettings& settings, Frame& frame);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sheaf::pipeline
