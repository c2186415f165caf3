#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/console.h"
#include "scenes/builtin.h"

namespace sheaf::cli {
namespace {

using Json = nlohmann::ordered_json;
using scenes::BuiltinInfo;
using scenes::BuiltinParameter;

std::string valueText(const BuiltinParameter& parameter, double value) {
  const auto word = static_cast<std::size_t>(value);
  return word < parameter.words.size() ? parameter.words[word] : fmt::format("{}", value);
}

std::string rangeText(const BuiltinParameter& parameter) {
  if (parameter.words.empty()) return fmt::format("{} to {}", parameter.min, parameter.max);
  std::string words;
  for (const std::string& word : parameter.words) words += fmt::format("{}{}", words.empty() ? "" : "|", word);
  return words;
}

std::string listText() {
  std::string text;
  for (const BuiltinInfo& info : scenes::builtinScenes()) {
    text += fmt::format("builtin:{:<14} {}\n", info.name, info.description);
    for (const BuiltinParameter& p : info.parameters)
      text += fmt::format("    {:<18} {} ({}, default {})\n", p.name, p.meaning, rangeText(p),
                          valueText(p, p.default_value));
  }
  return text;
}

std::string listJson() {
  Json list = Json::array();
  for (const BuiltinInfo& info : scenes::builtinScenes()) {
    Json parameters = Json::array();
    for (const BuiltinParameter& p : info.parameters) {
      Json entry = {{"name", p.name}, {"meaning", p.meaning}, {"default", p.default_value},
                    {"min", p.min},   {"max", p.max},         {"whole", p.whole}};
      if (!p.words.empty()) entry["words"] = p.words;
      parameters.push_back(std::move(entry));
    }
    list.push_back({{"name", info.name}, {"description", info.description}, {"parameters", std::move(parameters)}});
  }
  return list.dump(2) + "\n";
}

}  // namespace

void addScenesCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("scenes", "List the built-in scenes and their parameters");
  const auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "As JSON");
  command->footer(std::string("Example: sheaf render 'builtin:terrain?n=512' -o terrain.png\n\n") + kExitCodes);
  command->callback([json, &run] {
    run = [json] {
      writeStdout(*json ? listJson() : listText());
      return 0;
    };
  });
}

}  // namespace sheaf::cli
