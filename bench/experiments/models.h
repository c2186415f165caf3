// bench/experiments/models: the models of scripts/models, and simplified ones.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "mesh/mesh.h"

namespace sheaf::experiments {

class Models {
 public:
  explicit Models(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// As the file has it, without made normals; vertices that no face uses are dropped.
  /// name  cow, bunny, dragon, armadillo, jet, lantern. Throws Error if scripts/models has not fetched it.
  const mesh::Mesh& whole(const std::string& name);
  /// Simplified to so many vertices, or as few as topology allows; positions only.
  const mesh::Mesh& lod(const std::string& name, std::size_t vertices);

 private:
  std::filesystem::path folder_;
  std::map<std::pair<std::string, std::size_t>, mesh::Mesh> made_;
};

/// Median times in ms of several calls made in turns, so that a noisy machine's slow minutes fall on all of them; after
/// one turn that does not count.
std::vector<double> mediansInTurns(int runs, const std::vector<std::function<void()>>& calls);
/// The same of one call.
double medianMs(int runs, const std::function<void()>& call);

}  // namespace sheaf::experiments
