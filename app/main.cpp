#include <cstdio>
#include <exception>
#include <fmt/core.h>

#include "app/commands.h"
#include "app/manual.h"
#include "format/error.h"

using namespace gigabake;

int main(int argc, char** argv) {
  CLI::App program{"gigabake bakes textured terrain into a paged scene of sparse voxel oct-trees, and shows it."};
  program.set_version_flag("--version", "gigabake " GIGABAKE_VERSION);
  program.require_subcommand(1);
  int exit_code = app::complete;
  // One line per command, in the order --help lists them.
  app::add_sample(program, exit_code);
  app::add_plan(program, exit_code);
  app::add_bake(program, exit_code);
  app::add_status(program, exit_code);
  app::add_info(program, exit_code);
  app::add_verify(program, exit_code);
  app::add_diff(program, exit_code);
  app::add_export(program, exit_code);
  app::add_render(program, exit_code);
  app::add_view(program, exit_code);
  app::add_serve(program, exit_code);
  app::add_bench(program, exit_code);
  app::add_man(program);
  app::add_completion(program);
  app::add_bake_process(program);

  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    const int code = program.exit(e);
    return code == 0 ? app::complete : app::usage;
  } catch (const UsageError& e) {
    fmt::print(stderr, "gigabake: {}\n", e.what());
    return app::usage;
  } catch (const std::exception& e) {
    fmt::print(stderr, "gigabake: {}\n", e.what());
    return app::failed;
  }
  return exit_code;
}
