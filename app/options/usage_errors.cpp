#include "app/options/usage_errors.h"

#include <algorithm>
#include <fmt/format.h>

#include "app/command_tree.h"
#include "app/options/choices.h"
#include "core/base/error.h"
#include "core/base/quote.h"

namespace gigabake::app {
namespace {

constexpr std::size_t max_typed = 60;

/// Returns the count of letters changed, removed, inserted or swapped with their neighbour (optimal string alignment).
std::size_t edits_between(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), now(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    now[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      now[j] = std::min({last[j] + 1, now[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) now[j] = std::min(now[j], before[j - 2] + 1);
    }
    before.swap(last);
    last.swap(now);
  }
  return last[b.size()];
}

/// Returns the only known word that begins with `word`. Rejects words of fewer than four characters, because they match
/// too many.
std::optional<std::string> only_one_that_begins(const std::string& word, const std::vector<std::string>& known) {
  constexpr std::size_t min_characters = 4;
  std::optional<std::string> found;
  for (const std::string& candidate : known) {
    if (word.size() < min_characters || !candidate.starts_with(word)) continue;
    if (found) return std::nullopt;
    found = candidate;
  }
  return found;
}

/// Returns the commands on the command line, from the program down.
std::vector<const CLI::App*> named_commands(const CLI::App& program) {
  std::vector<const CLI::App*> path{&program};
  while (!path.back()->get_subcommands().empty()) path.push_back(path.back()->get_subcommands().front());
  return path;
}

std::string name_of(const std::vector<const CLI::App*>& path) {
  std::string name = "gigabake";
  for (std::size_t i = 1; i < path.size(); ++i) name += " " + path[i]->get_name();
  return name;
}

const Command& command_named(const Command& root, const std::string& name) {
  for (const Command* command : all_commands(root))
    if (command->name() == name) return *command;
  return root;
}

bool has_option(const Command& command, const std::string& name) {
  const std::vector<std::string> names = command.option_names();
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Returns the commands that have the option, such as "bake, plan"; empty if none has it.
std::string owners_of(const std::string& option, const Command& root) {
  std::vector<std::string> owners;
  for (const Command* command : all_commands(root))
    if (has_option(*command, option) && command->path.size() > 1)
      owners.push_back(command->name().substr(root.path[0].size() + 1));
  return joined(owners);
}

std::string unknown_option(const std::string& typed, const Command& command, const Command& root) {
  const std::string name = typed.substr(0, typed.find('='));
  if (has_option(command, name)) return fmt::format("{}: expected {} behind the command", root.path[0], name);
  std::string text = fmt::format("{}: unknown option {}", command.name(), in_quotes(name));
  if (const auto meant = meant_by(name, command.option_names()))
    return text + fmt::format("; did you mean {}?", *meant);
  const std::string owners = owners_of(name, root);
  return text + (owners.empty() ? fmt::format("; {} --help lists them", command.name())
                                : fmt::format(", which belongs to: {}", owners));
}

std::string unknown_command(const std::string& word, const Command& command) {
  std::vector<std::string> known;
  for (const Command& below : command.commands) known.push_back(below.path.back());
  const auto meant = meant_by(word, known);
  return fmt::format("{}: unknown command {}; {}", command.name(), in_quotes(word),
                     meant ? fmt::format("did you mean {}?", *meant) : "expected one of " + joined(known));
}

/// Returns the words that no parser consumed. `path` contains the parser of the program and of each given command.
std::vector<std::string> words_left(const std::vector<const CLI::App*>& path) {
  std::vector<std::string> words;
  for (const CLI::App* command : path)
    for (const std::string& word : command->remaining()) words.push_back(word);
  return words;
}

/// Returns the parser's own message with long option values shortened. A value may contain spaces.
std::string with_short_values(std::string text, const CLI::App& command) {
  for (const CLI::Option* option : command.get_options())
    for (const std::string& value : option->results())
      if (const auto at = text.find(value); value.size() > max_typed && at != std::string::npos)
        text.replace(at, value.size(), short_text(value, max_typed));
  return text;
}

std::string missing_arguments(const CLI::App& command, const std::string& name) {
  std::vector<std::string> missing;
  for (const CLI::Option* option : command.get_options())
    if (option->get_required() && option->count() == 0)
      missing.push_back(option->get_positional() ? option->get_name(true) : option->get_name(false, true));
  if (missing.empty()) return "";
  return fmt::format("{}: missing {}; {} --help has examples", name, joined(missing), name);
}

std::string wrong_words(const CLI::App& program, const CLI::ParseError& error) {
  const std::vector<const CLI::App*> path = named_commands(program);
  const Command root = command_tree(program, "gigabake");
  const Command& command = command_named(root, name_of(path));
  const std::vector<std::string> left = words_left(path);
  const auto is_option = [](const std::string& word) { return word.size() > 1 && word[0] == '-'; };
  if (!left.empty() && !is_option(left[0]) && !command.commands.empty()) return unknown_command(left[0], command);
  const auto option = std::find_if(left.begin(), left.end(), is_option);
  if (option != left.end()) return unknown_option(*option, command, root);
  if (!left.empty()) return fmt::format("{}: did not expect {}", command.name(), in_quotes(left[0]));
  if (!command.commands.empty())
    return fmt::format("{}: expected a command; {} --help lists them", command.name(), command.name());
  const std::string missing = missing_arguments(*path.back(), command.name());
  if (!missing.empty() && dynamic_cast<const CLI::RequiredError*>(&error) != nullptr) return missing;
  return fmt::format("{}: {}", command.name(), with_short_values(error.what(), *path.back()));
}

}  // namespace

std::optional<std::string> meant_by(const std::string& word, const std::vector<std::string>& known) {
  if (word.size() > max_typed) return std::nullopt;
  std::optional<std::string> nearest;
  std::size_t minimum = 0;
  for (const std::string& candidate : known) {
    const std::size_t edits = edits_between(word, candidate);
    if (3 * edits > candidate.size() || (nearest && edits >= minimum)) continue;
    nearest = candidate;
    minimum = edits;
  }
  return nearest ? nearest : only_one_that_begins(word, known);
}

std::string usage_error(const CLI::App& program, const CLI::ParseError& error) {
  return as_line(wrong_words(program, error));
}

}  // namespace gigabake::app
