#include "app/process/standard_streams.h"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <string>
#include <system_error>
#include <unistd.h>

#include "app/commands.h"
#include "format/system/message.h"

namespace gigabake::app {
namespace {

int noted_error = 0;  ///< errno of the first flush that failed

/// Returns 0, or the errno of the first failed flush of standard output, in this call or an earlier call.
int flush_error() {
  errno = 0;
  if (std::fflush(stdout) != 0 && noted_error == 0) noted_error = errno;
  return noted_error;
}

std::string failure(int error) {
  return std::string("cannot write standard output") + (error == 0 ? "" : std::string(": ") + std::strerror(error));
}

}  // namespace

void prepare_standard_streams() {
  for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; ++fd) {
    if (::fcntl(fd, F_GETFD) >= 0 || errno != EBADF) continue;
    const int direction = fd == STDIN_FILENO ? O_WRONLY : O_RDONLY;  // takes the lowest free number, which is `fd`
    if (::open("/dev/null", direction) < 0 && ::open("/", O_RDONLY | O_DIRECTORY) < 0) ::_exit(failed);
  }
  std::signal(SIGPIPE, SIG_IGN);
}

void put_output_before_messages() { flush_error(); }

void flush_output() {
  const int error = flush_error();
  if (error != 0 || has_output_failed()) throw std::system_error(error, std::generic_category(), "standard output");
}

bool has_output_failed() { return std::ferror(stdout) != 0; }

int end_of_output(int exit_code, int write_error) {
  const int error = flush_error();
  if (error == 0 && !has_output_failed()) return exit_code;
  const int reason = error != 0 ? error : write_error;
  if (reason == EPIPE && write_error == EPIPE) {  // the work was cut short: end like commands without a handler
    std::signal(SIGPIPE, SIG_DFL);
    std::raise(SIGPIPE);
  }
  if (reason == EPIPE) return exit_code;
  print_message("gigabake: {}\n", failure(reason));
  return exit_code == complete ? failed : exit_code;
}

}  // namespace gigabake::app
