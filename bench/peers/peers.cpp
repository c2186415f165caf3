// bench/peers: sheaf against Mesa llvmpipe on the same machine, in one run: the same triangles, camera, lights and
// shading, in turns, so that both meet the same disturbances. The pictures are compared too: equal work, or no result.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/peers/core_distance.h"
#include "bench/peers/peer_scene.h"
#include "core/error.h"
#include "core/task_pool.h"
#include "pipeline/prepare.h"
#include "pipeline/renderer.h"
#include "raster/image_compare.h"
#include "raster/image_io.h"
#include "scenes/builtin.h"
#include "scenes/camera.h"

namespace sheaf::peers {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 1920;
constexpr int kHeight = 1080;
constexpr double kAspect = static_cast<double>(kWidth) / kHeight;
constexpr double kFov = 40.0 * kPi / 180.0;
constexpr Vec3 kBackground(0.05F, 0.05F, 0.06F);

struct Options {
  int threads = 2;
  int frames = 15;
  int rounds = 5;
  std::string only;
  fs::path folder = "build/bench/peers";
};

struct Case {
  std::string name;
  std::string spec;
  bool full_screen_layers = false;
  bool from_within = false;  // the eye stands on the ground and sees a corner of it
};

const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      {"sphere, 1 M triangles", "sphere?n=289"},
      {"terrain, 2 M triangles, whole", "terrain?n=1001"},
      {"200 layers, front to back", "fill?layers=200&order=front_to_back", true},
      {"200 layers, back to front", "fill?layers=200&order=back_to_front", true},
      {"sphere, 100 k triangles", "sphere?n=91"},
      {"terrain, 95 % out of view", "terrain?n=1001", false, true},
  };
  return all;
}

struct View {
  scenes::Scene scene;
  scenes::Camera camera;
};

// The other side shades one way only: textures, solid textures, vertex colours and highlights are taken off.
void makePlain(scenes::Scene& scene) {
  for (scenes::Material& material : scene.materials) {
    if (material.base_color == Vec4(1.0F)) material.base_color = Vec4(0.6F, 0.55F, 0.5F, 1.0F);
    material.base_color_texture = {};
    material.solid = scenes::Solid::kNone;
    material.specular = 0.0F;
    material.shading = scenes::Shading::kSmooth;
    material.double_sided = false;
  }
  for (mesh::Mesh& mesh : scene.meshes) {
    mesh.colors.clear();
    mesh.texcoords.clear();
  }
}

scenes::Camera cameraWithin(const Box3& bounds) {
  const DVec3 lo(bounds.lo);
  const DVec3 size(bounds.size());
  scenes::Camera camera;
  camera.eye = lo + size * DVec3(0.75, 0.0, 0.75) + DVec3(0.0, size.y + 0.02 * size.x, 0.0);
  camera.target = lo + size * DVec3(1.0, 0.0, 1.0);
  camera.vertical_fov_rad = kFov;
  return camera;
}

View build(const Case& which) {
  View view{scenes::buildBuiltin(which.spec), {}};
  makePlain(view.scene);
  if (which.full_screen_layers) {
    view.camera = view.scene.cameras.at(0);
    // Exactly the picture, so that nobody has to clip.
    const Box3 bounds = scenes::boundsOf(view.scene);
    const DVec3 shrink(kAspect * view.camera.orthographic_height / bounds.size().x,
                       view.camera.orthographic_height / bounds.size().y, 1.0);
    for (mesh::Mesh& mesh : view.scene.meshes)
      for (Vec3& position : mesh.positions) position = Vec3(DVec3(position) * shrink);
  } else if (which.from_within) {
    view.camera = cameraWithin(scenes::boundsOf(view.scene));
  } else {
    view.camera = scenes::fitCamera(view.scene, scenes::namedView("iso"), kAspect, kFov, false, 0.0);
  }
  view.camera = scenes::fitClipPlanes(view.camera, scenes::boundsOf(view.scene));
  view.scene.lights.clear();
  scenes::addDefaultLights(view.scene, view.camera);
  return view;
}

template <typename Glm, std::size_t kSize>
void copyTo(std::array<float, kSize>& out, const Glm& value) {
  static_assert(sizeof value == sizeof out);
  std::memcpy(out.data(), &value, sizeof out);
}

::peers::PeerScene exported(const View& view) {
  ::peers::PeerScene out;
  out.frame.width = kWidth;
  out.frame.height = kHeight;
  out.frame.mesh_count = static_cast<std::uint32_t>(view.scene.instances.size());
  out.frame.light_count = static_cast<std::uint32_t>(view.scene.lights.size());
  for (std::size_t i = 0; i < view.scene.lights.size(); ++i) {
    copyTo(out.frame.lights.at(i).to_light_world, view.scene.lights[i].direction_to_light_world);
    copyTo(out.frame.lights.at(i).radiance, view.scene.lights[i].radiance);
  }
  copyTo(out.frame.ambient_sky, view.scene.ambient.sky);
  copyTo(out.frame.ambient_ground, view.scene.ambient.ground);
  copyTo(out.frame.background, kBackground);

  const DMat4 clip_from_world = scenes::clipFromView(view.camera, kAspect) * scenes::viewFromWorld(view.camera);
  for (const scenes::Instance& instance : view.scene.instances) {
    const mesh::Mesh& mesh = view.scene.meshes[instance.mesh];
    const Vec4& color = view.scene.materials[instance.material].base_color;
    ::peers::PeerDraw draw;
    copyTo(draw.mesh.clip_from_object, Mat4(clip_from_world * instance.world_from_object));
    copyTo(draw.mesh.world_from_object_normal, Mat3(glm::transpose(glm::inverse(DMat3(instance.world_from_object)))));
    copyTo(draw.mesh.base_color, Vec3(color));
    draw.mesh.vertex_count = static_cast<std::uint32_t>(mesh.vertexCount());
    draw.mesh.triangle_count = static_cast<std::uint32_t>(mesh.triangleCount());
    for (const Vec3& p : mesh.positions) draw.positions.insert(draw.positions.end(), {p.x, p.y, p.z});
    for (const Vec3& n : mesh.normals) draw.normals.insert(draw.normals.end(), {n.x, n.y, n.z});
    for (const mesh::Triangle& t : mesh.triangles) draw.indices.insert(draw.indices.end(), t.begin(), t.end());
    out.draws.push_back(std::move(draw));
  }
  return out;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

class SheafSide {
 public:
  SheafSide(scenes::Scene scene, const scenes::Camera& camera, int threads)
      : pool_(threads), prepared_(pipeline::prepareScene(std::move(scene), pool_)), camera_(camera) {
    settings_.width = kWidth;
    settings_.height = kHeight;
    settings_.background = Vec4(kBackground, 1.0F);
  }

  /// The median time of a frame in milliseconds.
  double time(int frames) {
    constexpr int kWarmUpFrames = 3;
    std::vector<double> ms;
    for (int i = 0; i < kWarmUpFrames + frames; ++i) {
      renderer_.render(prepared_, camera_, settings_, frame_);
      if (i >= kWarmUpFrames) ms.push_back(static_cast<double>(frame_.wall_ns) * 1e-6);
    }
    return median(std::move(ms));
  }
  const pipeline::Frame& frame() const { return frame_; }
  TaskPool& pool() { return pool_; }

 private:
  TaskPool pool_;
  pipeline::PreparedScene prepared_;
  scenes::Camera camera_;
  pipeline::RenderSettings settings_;
  pipeline::Renderer renderer_{pool_};
  pipeline::Frame frame_;
};

// Runs the other renderer's program and returns the line of JSON that it prints.
nlohmann::json timeLlvmpipe(const fs::path& scene, const Options& options, const fs::path& picture) {
  const std::string command = fmt::format("'{}' '{}' {} {} '{}'", SHEAF_LLVMPIPE_PROGRAM, scene.string(),
                                          options.frames, options.threads, picture.string());
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(popen(command.c_str(), "r"), &pclose);
  std::string output;
  for (char block[256]; pipe && std::fgets(block, sizeof block, pipe.get()) != nullptr;) output += block;
  if (output.empty()) throw Error(ErrorCode::kInternal, fmt::format("{}: failed", command));
  return nlohmann::json::parse(output);
}

struct Row {
  std::vector<double> sheaf_ms;
  std::vector<double> llvmpipe_ms;
  std::vector<double> core_distance_ns;
  std::vector<double> ratios;  // round by round: what disturbs one round disturbs both sides of it
  std::string renderer;
};

void compare(const Case& which, const Options& options) {
  View view = build(which);
  const std::string stem = which.spec.substr(0, which.spec.find('?')) + "-" + std::to_string(&which - cases().data());
  const fs::path scene_file = options.folder / (stem + ".scene");
  const fs::path llvmpipe_picture = options.folder / (stem + "-llvmpipe.png");
  const fs::path sheaf_picture = options.folder / (stem + "-sheaf.png");
  ::peers::writePeerScene(exported(view), scene_file.string());
  SheafSide sheaf(std::move(view.scene), view.camera, options.threads);

  Row row;
  for (int round = 0; round < options.rounds; ++round) {
    const nlohmann::json other = timeLlvmpipe(scene_file, options, llvmpipe_picture);
    row.renderer = other.at("renderer");
    row.llvmpipe_ms.push_back(other.at("median_ms"));
    row.core_distance_ns.push_back(coreDistanceNs());
    row.sheaf_ms.push_back(sheaf.time(options.frames));
    row.ratios.push_back(row.llvmpipe_ms.back() / row.sheaf_ms.back());
  }
  if (row.renderer.rfind("llvmpipe", 0) != 0)
    throw Error(ErrorCode::kInternal, fmt::format("GL is {}, not llvmpipe", row.renderer));

  fs::remove(scene_file);
  raster::writePng(sheaf_picture, sheaf.frame().color, sheaf.pool());
  const raster::ImageDifference difference =
      raster::compareImages(sheaf.frame().color, raster::readImage(llvmpipe_picture));
  const pipeline::Counters& counters = sheaf.frame().counters;
  const auto [lowest, highest] = std::minmax_element(row.ratios.begin(), row.ratios.end());
  fmt::print("{:30} {:9} {:8.1f} % {:9.2f} {:9.2f} {:7.1f}x {:6.1f}..{:.1f} {:9.3f} {:9.0f}\n", which.name,
             counters.triangles_in,
             100.0 * static_cast<double>(counters.triangles_assembled - counters.triangles_outside) /
                 static_cast<double>(counters.triangles_in),
             median(row.sheaf_ms), median(row.llvmpipe_ms), median(row.ratios), *lowest, *highest, difference.rms,
             median(row.core_distance_ns));
  std::fflush(stdout);
}

int run(const Options& options) {
  fs::create_directories(options.folder);
  fmt::print("{}x{}, {} threads each, median of {} rounds of {} frames in turns; pictures in {}\n", kWidth, kHeight,
             options.threads, options.rounds, options.frames, options.folder.string());
  fmt::print(
      "cores ns: a cache line from one core to another; where that is far, sheaf's two threads wait for each other\n");
  fmt::print("{:30} {:>9} {:>10} {:>9} {:>9} {:>8} {:>12} {:>9} {:>9}\n", "scene", "triangles", "assembled", "sheaf ms",
             "llvmpipe", "ratio", "of rounds", "RMS/255", "cores ns");
  for (const Case& which : cases())
    if (which.name.find(options.only) != std::string::npos) compare(which, options);
  return 0;
}

}  // namespace
}  // namespace sheaf::peers

int main(int argc, char** argv) {
  sheaf::peers::Options options;
  CLI::App app("sheaf against Mesa llvmpipe");
  app.add_option("--threads", options.threads, "worker threads of each")->capture_default_str();
  app.add_option("--frames", options.frames, "frames of a round")->capture_default_str()->check(CLI::PositiveNumber);
  app.add_option("--rounds", options.rounds, "rounds")->capture_default_str()->check(CLI::PositiveNumber);
  app.add_option("--only", options.only, "only scenes whose name contains this");
  app.add_option("--out", options.folder, "where the pictures go")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    return sheaf::peers::run(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "peers: {}\n", error.what());
    return 1;
  }
}
