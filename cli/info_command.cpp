#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/console.h"
#include "cli/saved_file.h"
#include "scenes/scene.h"

namespace sheaf::cli {
namespace {

using Json = nlohmann::ordered_json;
using scenes::Camera;
using scenes::Scene;

constexpr const char* kFooter =
    "Of a saved file it says what it holds and whether it is intact: one that was damaged, cut short or made by\n"
    "another version of sheaf is refused with exit code 3 or 4.\n"
    "\n"
    "Examples:\n"
    "  sheaf info model.glb --json\n"
    "  sheaf info groups.sheaf\n"
    "\n";

struct InfoOptions {
  std::string input;
  bool json = false;
  bool quiet = false;
};

struct MeshTotals {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  std::size_t with_texcoords = 0;
  std::size_t with_colors = 0;
};

MeshTotals totalsOf(const Scene& scene) {
  MeshTotals totals;
  for (const mesh::Mesh& mesh : scene.meshes) {
    totals.vertices += mesh.vertexCount();
    totals.triangles += mesh.triangleCount();
    totals.with_texcoords += mesh.texcoords.empty() ? 0 : 1;
    totals.with_colors += mesh.colors.empty() ? 0 : 1;
  }
  return totals;
}

std::string cameraText(const Camera& camera) {
  if (camera.orthographic_height > 0.0) return fmt::format("orthographic, {:.6g} high", camera.orthographic_height);
  return fmt::format("perspective, {:.4g} degrees", degrees(camera.vertical_fov_rad));
}

std::string infoText(const Scene& scene) {
  const MeshTotals totals = totalsOf(scene);
  std::string text = fmt::format("name        {}\n", scene.name);
  text +=
      fmt::format("meshes      {} ({} file vertices, {} triangles; {} with texture coordinates, {} with colours)\n",
                  scene.meshes.size(), totals.vertices, totals.triangles, totals.with_texcoords, totals.with_colors);
  text += fmt::format("instances   {} ({} file vertices, {} triangles in all)\n", scene.instances.size(),
                      scene.vertexCount(), scene.triangleCount());
  text += fmt::format("materials   {}\n", scene.materials.size());
  text += fmt::format("textures    {}", scene.textures.size());
  for (std::size_t i = 0; i < scene.textures.size(); ++i)
    text += fmt::format("{}{}x{}", i == 0 ? " (" : ", ", scene.textures[i].pixels.width(),
                        scene.textures[i].pixels.height());
  text += scene.textures.empty() ? "\n" : ")\n";
  const Box3 box = boundsOf(scene);
  if (box.empty()) {
    text += "bounds      empty\n";
  } else {
    const Vec3 size = box.size();
    text += fmt::format("bounds      ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g}), +Y up\n", box.lo.x, box.lo.y,
                        box.lo.z, box.hi.x, box.hi.y, box.hi.z);
    text += fmt::format("size        {:.6g} x {:.6g} x {:.6g}\n", size.x, size.y, size.z);
  }
  text += fmt::format("lights      {}\n", scene.lights.size());
  text += fmt::format("cameras     {}\n", scene.cameras.size());
  for (std::size_t i = 0; i < scene.cameras.size(); ++i)
    text += fmt::format("  {:<9} {}{}{}\n", i, scene.cameras[i].name, scene.cameras[i].name.empty() ? "" : ": ",
                        cameraText(scene.cameras[i]));
  return text + fmt::format("warnings    {}\n", scene.warnings.size());
}

template <typename Vector>
Json toJson(const Vector& v) {
  return Json::array({v.x, v.y, v.z});
}

Json toJson(const Camera& camera) {
  Json json = {
      {"name", camera.name}, {"eye", toJson(camera.eye)}, {"target", toJson(camera.target)}, {"up", toJson(camera.up)}};
  if (camera.orthographic_height > 0.0)
    json["orthographic_height"] = camera.orthographic_height;
  else
    json["vertical_fov_degrees"] = degrees(camera.vertical_fov_rad);
  return json;
}

std::string infoJson(const Scene& scene) {
  const MeshTotals totals = totalsOf(scene);
  Json textures = Json::array();
  for (const scenes::Texture& texture : scene.textures)
    textures.push_back(
        {{"name", texture.name}, {"width", texture.pixels.width()}, {"height", texture.pixels.height()}});
  Json materials = Json::array();
  for (const scenes::Material& material : scene.materials) materials.push_back({{"name", material.name}});
  Json cameras = Json::array();
  for (const Camera& camera : scene.cameras) cameras.push_back(toJson(camera));
  Json json = {{"name", scene.name},
               {"meshes", scene.meshes.size()},
               {"file_vertices", totals.vertices},
               {"mesh_triangles", totals.triangles},
               {"instances", scene.instances.size()},
               {"file_vertices_of_instances", scene.vertexCount()},
               {"triangles", scene.triangleCount()},
               {"materials", std::move(materials)},
               {"textures", std::move(textures)},
               {"bounds", nullptr},
               {"lights", scene.lights.size()},
               {"cameras", std::move(cameras)},
               {"warnings", scene.warnings}};
  if (const Box3 box = boundsOf(scene); !box.empty())
    json["bounds"] = {{"min", toJson(box.lo)}, {"max", toJson(box.hi)}};
  // Names come from files and need not be UTF-8.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

int runInfo(const InfoOptions& options) {
  if (isSavedFile(options.input)) {
    writeStdout(options.json ? savedFileJson(options.input) : savedFileText(options.input));
    return 0;
  }
  scenes::ImportOptions import;
  import.for_drawing = false;  // what is in the file
  const Scene scene = scenes::loadScene(options.input, import);
  if (!options.quiet && !options.json) printWarnings(scene.warnings);
  writeStdout(options.json ? infoJson(scene) : infoText(scene));
  return 0;
}

}  // namespace

void addInfoCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("info", "Say what is in a file");
  const auto options = std::make_shared<InfoOptions>();
  command
      ->add_option("INPUT", options->input,
                   "A mesh file, builtin:NAME, or a .sheaf file that group or cluster has saved")
      ->required();
  command->add_flag("--json", options->json, "As JSON, warnings included");
  command->add_flag("-q,--quiet", options->quiet, "No warnings on stderr");
  command->footer(std::string(kFooter) + kExitCodes);
  command->callback([options, &run] { run = [options] { return runInfo(*options); }; });
}

}  // namespace sheaf::cli
