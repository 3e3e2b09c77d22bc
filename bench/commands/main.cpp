#include <fmt/format.h>
#include <string>
#include <string_view>
#include <vector>

#include "app/command_tree.h"
#include "app/commands.h"
#include "app/process/bench_program.h"
#include "app/process/run_program.h"
#include "app/process/standard_streams.h"
#include "bench/commands/commands.h"
#include "format/system/message.h"

using namespace gigabake;

namespace {

int print_tree() {
  CLI::App program;
  program.set_help_flag("-h,--help", "this help, and exit");
  int exit_code = app::complete;
  app::add_bench(program, exit_code);
  fmt::print("{}\n", app::to_json(app::command_tree(program, "gigabake").commands.at(0)));
  return app::end_of_output(exit_code, 0);
}

}  // namespace

/// Parses `gigabake-bench ARGUMENTS` as `gigabake bench ARGUMENTS`.
int main(int argc, char** argv) {
  std::vector<const char*> words(argv + 1, argv + argc);
  if (const std::string_view option = app::bench_caller_option;
      !words.empty() && std::string_view(words[0]).starts_with(option)) {
    if (const auto error = app::other_version_error(words[0] + option.size())) {
      app::prepare_standard_streams();
      print_message("gigabake: {}\n", *error);
      return app::failed;
    }
    words.erase(words.begin());
  }
  const std::string first = words.empty() ? "" : words[0];
  if (first == app::bench_tree_option) return print_tree();
  if (first != "--version") words.insert(words.begin(), "bench");
  words.insert(words.begin(), "gigabake");
  return app::run_program(int(words.size()), words.data(), app::add_bench);
}
