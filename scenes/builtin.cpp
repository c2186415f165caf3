#include "scenes/builtin.h"

#include <fmt/format.h>

#include <cassert>
#include <charconv>
#include <functional>
#include <string_view>

#include "core/error.h"
#include "scenes/builtin_scenes.h"

namespace sheaf::scenes {
namespace {

struct Entry {
  BuiltinInfo info;
  std::function<Scene(const BuiltinArguments&)> build;
};

const std::vector<Entry>& entries() {
  static const std::vector<Entry> all = {
      {{"gallery",
        "curved and flat objects on a plinth: marble, wood, glaze, a painted globe; lights and camera of its own",
        {{"detail", 1, 1, 8, "tessellation: triangles grow with its square"}}},
       buildGallery},
      {{"teapot", "the Utah teapot, 32 bicubic patches", {{"n", 16, 1, 256, "quads along each side of a patch"}}},
       buildTeapot},
      {{"sphere",
        "smooth sphere of radius 1, closed, without texture coordinates: 12 n^2 triangles",
        {{"n", 64, 1, 1024, "quads along each side of the cube it is blown up from"}}},
       buildSphere},
      {{"torusknot",
        "marble tube along a torus knot: 2 u v triangles",
        {{"p", 2, 1, 16, "turns about the axis"},
         {"q", 3, 1, 16, "turns through the hole"},
         {"u", 512, 8, 16384, "quads along the tube"},
         {"v", 48, 3, 1024, "quads around the tube"},
         {"radius", 0.28, 0.01, 1.0, "of the tube; the torus has radii 2 and 0.8", false}}},
       buildTorusKnot},
      {{"terrain",
        "fractal hills coloured by height and slope: 2 (n - 1)^2 triangles",
        {{"n", 513, 2, 4096, "vertices along each side"},
         {"seed", 1, 0, 1000000, "another number, another landscape"},
         {"relief", 1.0, 0.0, 4.0, "factor on all heights", false}}},
       buildTerrain},
      {{"city",
        "blocks of buildings and trees, thousands of instances of a few meshes",
        {{"blocks", 10, 1, 64, "along each side"}, {"seed", 1, 0, 1000000, "another number, another city"}}},
       buildCity},
      {{"cornell",
        "the Cornell box: red and green walls and two blocks",
        {{"n", 24, 1, 256, "quads along each side of every wall"}}},
       buildCornell},
      {{"fill",
        "quads that each cover the whole picture: a load of pixels without a load of vertices",
        {{"layers", 16, 1, 1024, "number of quads"},
         {"order",
          static_cast<double>(FillOrder::kFrontToBack),
          0,
          2,
          "order in which they are drawn",
          true,
          {"front_to_back", "back_to_front", "shuffled"}},
         {"n", 1, 1, 256, "quads that each layer is cut into along each side"}}},
       buildFill},
  };
  return all;
}

std::string listOf(const BuiltinParameter& p) {
  if (!p.words.empty()) return fmt::format("{}={}", p.name, fmt::join(p.words, "|"));
  return fmt::format("{}={}..{}", p.name, p.min, p.max);
}

std::string listOf(const std::vector<BuiltinParameter>& parameters) {
  std::vector<std::string> items;
  for (const BuiltinParameter& p : parameters) items.push_back(listOf(p));
  return fmt::format("{}", fmt::join(items, ", "));
}

[[noreturn]] void refuse(const std::string& scene, const std::string& reason) {
  throw Error(ErrorCode::kUsage, fmt::format("builtin:{}: {}", scene, reason));
}

const Entry& findEntry(const std::string& name) {
  std::vector<std::string> names;
  for (const Entry& e : entries()) {
    if (e.info.name == name) return e;
    names.push_back(e.info.name);
  }
  refuse(name, fmt::format("no such scene; there are {}", fmt::join(names, ", ")));
}

double parseValue(const std::string& scene, const BuiltinParameter& p, std::string_view text) {
  for (std::size_t i = 0; i < p.words.size(); ++i)
    if (text == p.words[i]) return static_cast<double>(i);
  double value = 0.0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number = failure == std::errc() && end == text.data() + text.size();
  // Written so that NaN fails too.
  if (!is_number || !(value >= p.min && value <= p.max) || (p.whole && value != std::floor(value)))
    refuse(scene, fmt::format("{} is \"{}\", must be {} {}", p.name, text, p.whole ? "a whole number," : "a number,",
                              listOf(p)));
  return value;
}

}  // namespace

double BuiltinArguments::number(const std::string& name) const {
  for (const auto& [key, value] : values_)
    if (key == name) return value;
  assert(!"every parameter has a value");
  return 0.0;
}

const std::vector<BuiltinInfo>& builtinScenes() {
  static const std::vector<BuiltinInfo> infos = [] {
    std::vector<BuiltinInfo> result;
    for (const Entry& e : entries()) result.push_back(e.info);
    return result;
  }();
  return infos;
}

Scene buildBuiltin(const std::string& spec) {
  const std::size_t question = spec.find('?');
  const std::string name = spec.substr(0, question);
  const Entry& entry = findEntry(name);
  const std::vector<BuiltinParameter>& parameters = entry.info.parameters;

  std::vector<std::pair<std::string, double>> values;
  for (const BuiltinParameter& p : parameters) values.emplace_back(p.name, p.default_value);
  std::vector<bool> given(parameters.size(), false);

  std::string_view rest =
      question == std::string::npos ? std::string_view() : std::string_view(spec).substr(question + 1);
  while (!rest.empty()) {
    const std::string_view item = rest.substr(0, rest.find('&'));
    rest.remove_prefix(std::min(rest.size(), item.size() + 1));
    const std::size_t equals = item.find('=');
    const std::string_view key = item.substr(0, equals);
    std::size_t index = 0;
    while (index < parameters.size() && parameters[index].name != key) ++index;
    if (index == parameters.size())
      refuse(name, fmt::format("no parameter \"{}\"; there are {}", key, listOf(parameters)));
    if (equals == std::string_view::npos)
      refuse(name, fmt::format("{} has no value: {}", key, listOf(parameters[index])));
    if (given[index]) refuse(name, fmt::format("{} is given twice", key));
    given[index] = true;
    values[index].second = parseValue(name, parameters[index], item.substr(equals + 1));
  }

  Scene scene = entry.build(BuiltinArguments(std::move(values)));
  scene.name = name;
  return scene;
}

}  // namespace sheaf::scenes
