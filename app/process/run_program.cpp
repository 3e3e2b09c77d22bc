#include "app/process/run_program.h"

#include <exception>
#include <system_error>

#include "app/commands.h"
#include "app/manual/about.h"
#include "app/manual/help_sections.h"
#include "app/options/flags.h"
#include "app/options/usage_errors.h"
#include "app/process/missing_report.h"
#include "app/process/out_of_memory.h"
#include "app/process/standard_streams.h"
#include "app/process/stop_signal.h"
#include "core/base/error.h"
#include "core/base/progress.h"
#include "format/system/message.h"

namespace gigabake::app {
namespace {

/// Returns the exit code. If a write to standard output failed, sets `write_error` to its errno.
int run(int argc, const char* const* argv, const AddCommands& add_commands, int& write_error) {
  CLI::App program{"gigabake bakes textured terrain into a paged scene of sparse voxel oct-trees, and shows it."};
  program.set_version_flag("--version", about, "version, commit, formats and libraries, and exit");
  program.set_help_flag("-h,--help", "this help, and exit");
  program.require_subcommand(1);
  int exit_code = complete;
  add_commands(program, exit_code);
  add_help_sections(program);

  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return program.exit(e);  // --help, --version
    print_message("{}\n", usage_error(program, e));
    return usage;
  } catch (const UsageError& e) {
    print_message("gigabake: {}\n", error_text(e));
    return usage;
  } catch (const Stopped&) {
    print_message("{}\n", stop_line());
    return exit_code_of_stop();
  } catch (const std::exception& e) {
    const auto* of_system = dynamic_cast<const std::system_error*>(&e);
    if (has_output_failed()) {
      write_error = of_system == nullptr ? 0 : of_system->code().value();
      return failed;
    }
    print_message("gigabake: {}\n", error_text(e));
    return failed;
  }
  return report_missing_data(exit_code);
}

}  // namespace

int run_program(int argc, const char* const* argv, const AddCommands& add_commands) {
  prepare_standard_streams();
  install_out_of_memory_handler();
  int write_error = 0;
  const int exit_code = run(argc, argv, add_commands, write_error);
  return end_of_output(exit_code, write_error);
}

}  // namespace gigabake::app
