#include "app/manual/manual.h"

#include <algorithm>
#include <fmt/format.h>
#include <memory>
#include <utility>

#include "app/manual/completion.h"
#include "app/manual/man_page.h"
#include "app/manual/man_viewer.h"
#include "app/options/choices.h"
#include "app/process/bench_program.h"
#include "core/base/error.h"
#include "format/system/publish.h"

namespace gigabake::app {
namespace {

struct ManOptions {
  std::vector<std::string> command;
  std::string folder;
};

const Command& command_named(const Command& root, const std::vector<std::string>& words) {
  std::vector<std::string> path{root.path};
  path.insert(path.end(), words.begin(), words.end());
  const std::vector<const Command*> all = all_commands(root);
  const auto found = std::find_if(all.begin(), all.end(), [&](const Command* c) { return c->path == path; });
  if (found == all.end()) throw UsageError("man: there is no command '" + Command{path, "", {}, {}}.name() + "'");
  return **found;
}

/// Returns the words that name commands, without hidden commands.
std::vector<std::string> command_words(const CLI::App& app) {
  const Command root = command_tree(app, "gigabake");
  std::vector<std::string> words;
  for (const Command* command : all_commands(root))
    if (command->path.size() > 1 && std::find(words.begin(), words.end(), command->path.back()) == words.end())
      words.push_back(command->path.back());
  return words;
}

/// Returns all commands with their options; without the options of the benchmarks if gigabake-bench is missing.
Command complete_tree(const CLI::App& app) {
  Command root = command_tree(app, "gigabake");
  const auto bench = std::ranges::find_if(root.commands, [](const Command& c) { return c.path.back() == "bench"; });
  if (auto tree = bench_tree()) *bench = std::move(*tree);
  return root;
}

}  // namespace

void add_man(CLI::App& app) {
  auto* command = app.add_subcommand(
      "man",
      "Print the manual page of a command: formatted and paged on a terminal, as input for man in a pipe or file");
  auto o = std::make_shared<ManOptions>();
  command->add_option("COMMAND", o->command, "words of the command, such as bench render; none: gigabake itself")
      ->check(one_of(command_words(app)));
  command->add_option("--all", o->folder, "folder to write the pages of all commands to, instead");
  command->callback([o, &app] {
    const Command root = complete_tree(app);
    if (o->folder.empty()) return show_man_page(man_page(command_named(root, o->command), root));
    for (const Command* page : all_commands(root))
      publish_file(std::filesystem::path(o->folder) / man_file(*page), man_page(*page, root), Durability::while_up);
  });
}

void add_completion(CLI::App& app) {
  auto* command =
      app.add_subcommand("completion", "Print the completion script of a shell: source <(gigabake completion bash)");
  auto shell = std::make_shared<std::string>();
  command->add_option("SHELL", *shell, "name of the shell")->required()->check(one_of({"bash", "zsh", "fish"}));
  command->callback([shell, &app] {
    const Command root = complete_tree(app);
    fmt::print("{}", *shell == "bash"  ? bash_completion(root)
                     : *shell == "zsh" ? zsh_completion(root)
                                       : fish_completion(root));
  });
}

}  // namespace gigabake::app
