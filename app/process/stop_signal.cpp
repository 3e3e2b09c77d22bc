#include "app/process/stop_signal.h"

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fmt/format.h>
#include <stdexcept>

namespace gigabake::app {
namespace {

volatile std::sig_atomic_t noted_signal = 0;

void note_signal(int signal) { noted_signal = signal; }

void handle_signal(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART | SA_RESETHAND;
  if (::sigaction(signal, &action, nullptr) != 0) throw std::runtime_error("sigaction failed");
}

}  // namespace

StopSignals::StopSignals() {
  handle_signal(SIGINT, note_signal);
  handle_signal(SIGTERM, note_signal);
}

StopSignals::~StopSignals() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

int stop_signal() { return noted_signal; }

std::string stop_line() {
  return fmt::format("gigabake: stopped by {}; nothing is left half-written",
                     noted_signal == SIGINT ? "SIGINT" : "SIGTERM");
}

int exit_code_of_stop() { return 128 + (noted_signal != 0 ? int(noted_signal) : SIGTERM); }

void end_as_stopped() {
  fmt::print(stderr, "{}\n", stop_line());
  std::_Exit(exit_code_of_stop());
}

}  // namespace gigabake::app
