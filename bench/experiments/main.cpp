// experiments --list | NAME: see experiment.h.
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string_view>
#include <thread>

#include "bench/experiments/experiment.h"
#include "cli/build_info.h"
#include "core/file.h"
#include "raster/image_io.h"

namespace sheaf::experiments {
namespace {

std::string writeMachine(Context&) {
  return fmt::format("{}, {} processors; {}.\n\n", cli::cpuModel(), std::thread::hardware_concurrency(),
                     cli::buildText());
}

}  // namespace

const std::vector<Section>& sections() {
  static const std::vector<Section> all = {
      {"machine", "Machine", writeMachine},
      {"models", "Models", writeModels},
      {"table1", "Table 1: vertices eliminated and time", writeTable1},
      {"figure7", "Figure 7: elimination and vertex count", writeFigure7},
      {"averages", "Averages: planar, linear, linear in two dimensions", writeAverages},
      {"growth", "Time and vertex count", writeGrowth},
      {"quadric", "Quadric and distance metric", writeQuadric},
      {"ellipsoids", "Figures 3 and 5: ellipsoids", writeEllipsoids},
      {"figure8", "Figure 8: levels of detail", writeFigure8},
      {"figure9", "Figure 9: a coarse cow, a large epsilon", writeFigure9},
      {"figure10", "Figure 10: a bunny of marble", writeFigure10},
      {"planes", "Planes that are not aligned with the axes", writePlanes},
      {"search", "Greedy and better search", writeSearch},
      {"costs", "Operation counts", writeCosts},
      {"scalar", "Transforms without vectors: instructions", writeScalar},
      {"scalar-times", "Transforms without vectors: time", writeScalarTimes},
      {"clipping", "Clipping by group without vectors", writeClipping},
      {"kernels", "What bounds the vector kernels", writeKernels},
      {"large", "Transform and clipping of large meshes", writeLarge},
      {"sweep", "Transform and clipping from 300 vertices up", writeSweep},
      {"visible", "A part of the mesh in view", writeVisible},
      {"frames", "Whole frames", writeFrames},
      {"texcoords", "Transforming and generating texture coordinates", writeTexcoordTransforms},
      {"storage", "Storage", writeStorage},
      {"beyond", "Normals, texture coordinates, moving vertices", writeBeyond},
      {"simplification", "Simplification", writeSimplification},
      {"clustering", "Hierarchical face clustering", writeClustering},
      {"patch-groups", "Planes of patches", writePatchGroups},
  };
  return all;
}

std::string showPicture(Context& context, const std::string& file, const Image8& picture, const std::string& caption) {
  raster::writePng(context.docs / "experiments" / file, picture, context.pool);
  return fmt::format("![{}](experiments/{})\n\n*{}*\n\n", file, file, caption);
}

std::string showChart(Context& context, const std::string& file, const std::string& svg, const std::string& caption) {
  writeFile(context.docs / "experiments" / file, svg);
  return fmt::format("![{}](experiments/{})\n\n*{}*\n\n", file, file, caption);
}

namespace {

std::string write(std::string_view name) {
  for (const Section& section : sections()) {
    if (section.name != name) continue;
    Context context{Models("models"), "docs", TaskPool(1)};
    std::filesystem::create_directories(context.docs / "experiments");
    return fmt::format("## {}\n\n`scripts/bench paper {}`\n\n{}", section.title, section.name, section.write(context));
  }
  throw std::runtime_error(fmt::format("no section {}; see --list", name));
}

}  // namespace
}  // namespace sheaf::experiments

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: experiments --list | NAME    (in the project's folder)\n");
    return 2;
  }
  try {
    if (argv[1] == std::string_view("--list"))
      for (const auto& section : sheaf::experiments::sections()) fmt::print("{}\n", section.name);
    else
      fmt::print("{}", sheaf::experiments::write(argv[1]));
    return 0;
  } catch (const std::exception& e) {
    fmt::print(stderr, "experiments {}: {}\n", argv[1], e.what());
    return 1;
  }
}
