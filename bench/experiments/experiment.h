// bench/experiments: the measurements and pictures of docs/experiments.md. Each section is written by a function of its
// own, to stdout as Markdown and into files beside the document; scripts/bench paper runs them and puts them together.
//   Keeps  but for times, the same figures in every run: same models, same counts, fixed seeds
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/experiments/models.h"
#include "core/image.h"
#include "core/task_pool.h"

namespace sheaf::experiments {

/// What a section works with.
struct Context {
  Models models;
  std::filesystem::path docs;  ///< the folder of experiments.md; its pictures go to experiments/ below
  TaskPool pool;
};

struct Section {
  std::string name;   ///< as in `scripts/bench paper NAME`
  std::string title;  ///< of its heading
  /// Returns what stands below the heading. Throws std::runtime_error if a result is not what it has to be.
  std::string (*write)(Context& context);
};

/// All of them, in the order of the document.
const std::vector<Section>& sections();

// elimination.cpp
std::string writeModels(Context& context);
std::string writeTable1(Context& context);
std::string writeFigure7(Context& context);
std::string writeAverages(Context& context);
std::string writePlanes(Context& context);
std::string writeSearch(Context& context);
// clustering.cpp
std::string writeClustering(Context& context);
// patch_groups.cpp
std::string writePatchGroups(Context& context);
// growth.cpp
std::string writeGrowth(Context& context);
std::string writeSimplification(Context& context);
// quality.cpp
std::string writeQuadric(Context& context);
std::string writeEllipsoids(Context& context);
std::string writeFigure8(Context& context);
std::string writeFigure9(Context& context);
std::string writeFigure10(Context& context);
// costs.cpp
std::string writeCosts(Context& context);
std::string writeStorage(Context& context);
std::string writeBeyond(Context& context);
// scalar.cpp, clipping.cpp, texcoords.cpp
std::string writeScalar(Context& context);
std::string writeScalarTimes(Context& context);
std::string writeClipping(Context& context);
std::string writeTexcoordTransforms(Context& context);
// stage.cpp
std::string writeKernels(Context& context);
std::string writeLarge(Context& context);
std::string writeSweep(Context& context);
std::string writeVisible(Context& context);
std::string writeFrames(Context& context);

/// Writes a file below docs/experiments and returns the Markdown that shows it.
std::string showPicture(Context& context, const std::string& file, const Image8& picture, const std::string& caption);
std::string showChart(Context& context, const std::string& file, const std::string& svg, const std::string& caption);

}  // namespace sheaf::experiments
