#include "cluster/mpi/mpi_call_timeout.h"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fmt/format.h>
#include <stdexcept>
#include <string>
#include <sys/time.h>
#include <unistd.h>

#include "cluster/launch/launcher.h"

namespace gigabake {
namespace {

constexpr double default_s = 120, min_s = 1, max_s = 86400;
constexpr int printing_ranks = 2;  // two, because rank 0 may be the one that hangs

/// The line printed by the signal handler, which must not allocate.
char last_line[300];
std::size_t last_line_bytes = 0;

void end_by_timeout(int signal) {
  if (last_line_bytes != 0 && ::write(STDERR_FILENO, last_line, last_line_bytes) < 0) {
    // A failed write is ignored; the process ends anyway.
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);  // takes effect when this handler returns
}

void set_timer(double seconds) {
  itimerval timer{};
  timer.it_value.tv_sec = time_t(seconds);
  timer.it_value.tv_usec = suseconds_t((seconds - std::floor(seconds)) * 1e6);
  if (::setitimer(ITIMER_REAL, &timer, nullptr) != 0) throw std::runtime_error("setitimer failed");
}

}  // namespace

double max_mpi_call_s() {
  const char* text = std::getenv("GIGABAKE_MPI_SECONDS");
  const double seconds = text == nullptr ? 0 : std::strtod(text, nullptr);
  return seconds >= min_s && seconds <= max_s ? seconds : default_s;
}

MpiCallTimeout::MpiCallTimeout(double limit_s, const char* call) {
  const std::string line = fmt::format(
      "gigabake: {} did not return within {:g} s: another rank died or hangs; run the same command again "
      "(GIGABAKE_MPI_SECONDS sets this limit)\n",
      call, limit_s);
  const int rank = rank_from_launcher(environment_of_process);
  last_line_bytes = rank < printing_ranks ? std::min(line.size(), sizeof last_line) : 0;
  std::memcpy(last_line, line.data(), last_line_bytes);
  if (std::signal(SIGALRM, end_by_timeout) == SIG_ERR) throw std::runtime_error("signal(SIGALRM) failed");
  set_timer(limit_s);
}

MpiCallTimeout::~MpiCallTimeout() {
  const itimerval none{};
  ::setitimer(ITIMER_REAL, &none, nullptr);
  std::signal(SIGALRM, SIG_DFL);
}

}  // namespace gigabake
