#include <exception>
#include <system_error>

#include "app/commands.h"
#include "app/manual/about.h"
#include "app/manual/help_sections.h"
#include "app/manual/manual.h"
#include "app/options/flags.h"
#include "app/options/usage_errors.h"
#include "app/process/missing_report.h"
#include "app/process/out_of_memory.h"
#include "app/process/standard_streams.h"
#include "app/process/stop_signal.h"
#include "core/base/error.h"
#include "core/base/progress.h"
#include "format/system/message.h"

using namespace gigabake;

namespace {

/// Returns the exit code. write_error: set to the errno of a write to standard output that failed.
int run(int argc, char** argv, int& write_error) {
  CLI::App program{"gigabake bakes textured terrain into a paged scene of sparse voxel oct-trees, and shows it."};
  program.set_version_flag("--version", app::about, "version, commit, formats and libraries, and exit");
  program.set_help_flag("-h,--help", "this help, and exit");
  program.require_subcommand(1);
  int exit_code = app::complete;
  // Add the commands in the order in which --help lists them.
  app::add_sample(program, exit_code);
  app::add_plan(program, exit_code);
  app::add_bake(program, exit_code);
  app::add_status(program, exit_code);
  app::add_info(program, exit_code);
  app::add_verify(program, exit_code);
  app::add_diff(program, exit_code);
  app::add_export(program, exit_code);
  app::add_render(program, exit_code);
  app::add_query(program, exit_code);
  app::add_view(program, exit_code);
  app::add_serve(program, exit_code);
  app::add_bench(program, exit_code);
  app::add_completion(program);
  app::add_man(program);
  app::add_bake_process(program);
  app::add_help_sections(program);

  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return program.exit(e);  // --help, --version
    print_message("{}\n", app::usage_error(program, e));
    return app::usage;
  } catch (const UsageError& e) {
    print_message("gigabake: {}\n", app::said(e));
    return app::usage;
  } catch (const Stopped&) {
    print_message("{}\n", app::stop_line());
    return app::exit_code_of_stop();
  } catch (const std::exception& e) {
    const auto* of_system = dynamic_cast<const std::system_error*>(&e);
    if (app::has_output_failed()) {
      write_error = of_system == nullptr ? 0 : of_system->code().value();
      return app::failed;
    }
    print_message("gigabake: {}\n", app::said(e));
    return app::failed;
  }
  return app::report_missing_data(exit_code);
}

}  // namespace

int main(int argc, char** argv) {
  app::prepare_standard_streams();
  app::install_out_of_memory_handler();
  int write_error = 0;
  const int exit_code = run(argc, argv, write_error);
  return app::end_of_output(exit_code, write_error);
}
