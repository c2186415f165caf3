#include "bench/experiments/models.h"

#include <algorithm>

#include "core/stage_timer.h"
#include "mesh/simplify.h"
#include "scenes/join.h"
#include "scenes/scene.h"

namespace sheaf::experiments {
namespace {

const std::map<std::string, std::string>& files() {
  static const std::map<std::string, std::string> names = {{"cow", "cow.off"},
                                                           {"bunny", "bun_zipper.ply"},
                                                           {"dragon", "dragon_vrip.ply.gz"},
                                                           {"armadillo", "armadillo.off"},
                                                           {"jet", "f16.obj"},
                                                           {"lantern", "Lantern/Lantern.gltf"}};
  return names;
}

template <typename Attribute>
void keepOnly(const std::vector<std::uint32_t>& kept, std::vector<Attribute>& values) {
  if (values.empty()) return;
  for (std::size_t i = 0; i < kept.size(); ++i) values[i] = values[kept[i]];
  values.resize(kept.size());
}

void dropUnused(mesh::Mesh& mesh) {
  std::vector<std::uint32_t> number(mesh.vertexCount(), 0), kept;
  for (const mesh::Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) number[v] = 1;
  for (std::uint32_t v = 0; v < number.size(); ++v)
    if (number[v] != 0) {
      number[v] = static_cast<std::uint32_t>(kept.size());
      kept.push_back(v);
    }
  for (mesh::Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t) v = number[v];
  keepOnly(kept, mesh.positions);
  keepOnly(kept, mesh.normals);
  keepOnly(kept, mesh.texcoords);
  keepOnly(kept, mesh.colors);
}

}  // namespace

const mesh::Mesh& Models::whole(const std::string& name) {
  const auto [entry, is_new] = made_.try_emplace({name, 0});
  if (is_new) {
    scenes::ImportOptions options;
    options.for_drawing = false;
    entry->second = scenes::joinedMesh(scenes::loadScene((folder_ / files().at(name)).string(), options));
    dropUnused(entry->second);
  }
  return entry->second;
}

const mesh::Mesh& Models::lod(const std::string& name, std::size_t vertices) {
  const auto [entry, is_new] = made_.try_emplace({name, vertices});
  if (is_new) {
    mesh::SimplifyOptions options;
    options.target_vertices = vertices;
    entry->second = mesh::simplify(whole(name), options).mesh;
  }
  return entry->second;
}

std::vector<double> mediansInTurns(int runs, const std::vector<std::function<void()>>& calls) {
  std::vector<std::vector<double>> times(calls.size());
  for (int i = 0; i <= runs; ++i)
    for (std::size_t c = 0; c < calls.size(); ++c) {
      const std::int64_t begin_ns = nowNs();
      calls[c]();
      if (i > 0) times[c].push_back(1e-6 * static_cast<double>(nowNs() - begin_ns));
    }
  std::vector<double> medians;
  for (std::vector<double>& t : times) {
    std::nth_element(t.begin(), t.begin() + runs / 2, t.end());
    medians.push_back(t[static_cast<std::size_t>(runs / 2)]);
  }
  return medians;
}

double medianMs(int runs, const std::function<void()>& call) {
  return mediansInTurns(runs, {call}).front();
}

}  // namespace sheaf::experiments
