#include "app/process/stop_signal.h"

#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fmt/format.h>
#include <stdexcept>
#include <unistd.h>

#include "format/system/message.h"

namespace gigabake::app {
namespace {

volatile std::sig_atomic_t received_signal = 0;

const char* last_words_of_stop = nullptr;

void note_signal(int signal) {
  if (received_signal == 0) {
    received_signal = signal;
    return;
  }
  if (::write(STDERR_FILENO, last_words_of_stop, std::strlen(last_words_of_stop)) < 0) {
    // The write failed, for example on a closed pipe; the process ends anyway.
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);  // takes effect when this handler returns
}

void handle_signal(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  if (::sigaction(signal, &action, nullptr) != 0) throw std::runtime_error("sigaction failed");
}

}  // namespace

StopSignals::StopSignals(const char* last_words) {
  last_words_of_stop = last_words;
  handle_signal(SIGINT, note_signal);
  handle_signal(SIGTERM, note_signal);
}

StopSignals::~StopSignals() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

int stop_signal() { return received_signal; }

std::string stop_line() {
  return fmt::format("gigabake: stopped by {}; nothing is left half-written",
                     received_signal == SIGINT ? "SIGINT" : "SIGTERM");
}

int exit_code_of_stop() { return 128 + (received_signal != 0 ? int(received_signal) : SIGTERM); }

void exit_as_stopped() {
  print_message("{}\n", stop_line());
  std::_Exit(exit_code_of_stop());
}

}  // namespace gigabake::app
