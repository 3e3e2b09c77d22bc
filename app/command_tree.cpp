#include "app/command_tree.h"

#include <nlohmann/json.hpp>

#include "app/options/choices.h"

namespace gigabake::app {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CommandOption, names, value, choices, default_value, description, is_positional,
                                   is_required)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Command, path, description, options, commands)

namespace {

CommandOption option_of(const CLI::Option& option) {
  CommandOption o;
  o.is_positional = option.get_positional();
  o.is_required = option.get_required();
  o.description = option.get_description();
  o.default_value = option.get_default_str();
  for (const std::string& name : option.get_snames()) o.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) o.names.push_back("--" + name);
  if (o.is_positional) o.names = {option.get_name(true)};
  if (option.get_items_expected_max() == 0) return o;
  const std::string type = option.get_type_name();
  o.choices = choices_in(type);
  o.value = type.substr(0, type.find_first_of(": "));
  if (o.value.empty()) o.value = "VALUE";
  return o;
}

Command command_of(const CLI::App& app, std::vector<std::string> path) {
  Command command;
  command.description = app.get_description();
  for (const CLI::Option* option : app.get_options())
    if (!option->get_group().empty()) command.options.push_back(option_of(*option));
  for (const CLI::App* below : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (below->get_group().empty()) continue;
    std::vector<std::string> words = path;
    words.push_back(below->get_name());
    command.commands.push_back(command_of(*below, std::move(words)));
  }
  command.path = std::move(path);
  return command;
}

void append_all(const Command& command, std::vector<const Command*>& all) {
  all.push_back(&command);
  for (const Command& below : command.commands) append_all(below, all);
}

}  // namespace

std::string Command::name(const char* separator) const {
  std::string text;
  for (const std::string& word : path) text += (text.empty() ? "" : separator) + word;
  return text;
}

std::vector<std::string> Command::option_names() const {
  std::vector<std::string> names;
  for (const CommandOption& o : options)
    if (!o.is_positional) names.insert(names.end(), o.names.begin(), o.names.end());
  return names;
}

Command command_tree(const CLI::App& program, const std::string& name) { return command_of(program, {name}); }

std::string to_json(const Command& command) { return nlohmann::json(command).dump(); }

Command command_from_json(const std::string& text) { return nlohmann::json::parse(text).get<Command>(); }

std::vector<const Command*> all_commands(const Command& root) {
  std::vector<const Command*> all;
  append_all(root, all);
  return all;
}

}  // namespace gigabake::app
