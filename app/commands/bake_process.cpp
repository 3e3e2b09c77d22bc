#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fmt/core.h>
#include <memory>
#include <stdexcept>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "app/commands.h"
#include "app/options/flags.h"
#include "core/base/error.h"
#include "format/system/message.h"
#include "worker/pipeline/bake_service.h"

namespace gigabake::app {
namespace {

/// Ends this process when the supervisor at the other end of the socket dies, even if it does not close the socket.
void follow_supervisor(int fd) {
  ucred supervisor{};
  socklen_t size = sizeof supervisor;
  if (::getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &supervisor, &size) != 0)
    throw UsageError("bake-process: expected the number of a socket; `gigabake bake` starts it");
  if (::prctl(PR_SET_PDEATHSIG, SIGKILL) != 0) throw std::runtime_error("bake-process: prctl(PR_SET_PDEATHSIG) failed");
  if (::getppid() != supervisor.pid) std::_Exit(failed);  // the supervisor died before prctl()
}

/// Ignores signals of a terminal or a job scheduler; the supervisor handles them.
void leave_signals_to_supervisor() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGUSR2, SIGPIPE})
    if (std::signal(signal, SIG_IGN) == SIG_ERR) throw std::runtime_error("bake-process: signal() failed");
}

/// Names the process. It is started as /proc/self/exe, so top and the kernel's out-of-memory log would show "exe".
void take_name() {
  if (::prctl(PR_SET_NAME, "gigabake-bake") != 0) throw std::runtime_error("bake-process: prctl(PR_SET_NAME) failed");
}

int run(int fd) {
  try {
    leave_signals_to_supervisor();
    follow_supervisor(fd);
    take_name();
    return serve_bakes(fd);
  } catch (const UsageError& e) {
    print_message("gigabake: {}\n", error_text(e));
    return usage;
  } catch (const std::exception& e) {
    print_message("gigabake: bake process: {}\n", error_text(e));
    return failed;
  }
}

}  // namespace

void add_bake_process(CLI::App& app) {
  auto* command = app.add_subcommand("bake-process", "Process that `gigabake bake` starts on each rank")->group("");
  auto fd = std::make_shared<int>(-1);
  command->add_option("FD", *fd, "number of the socket to the supervisor")->required();
  command->callback([fd] { std::_Exit(run(*fd)); });  // _Exit, because serve_bakes leaves threads running
}

}  // namespace gigabake::app
