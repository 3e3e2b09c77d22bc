#include "cluster/process/drain.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <sys/prctl.h>
#include <unistd.h>

namespace gigabake {
namespace {

volatile std::sig_atomic_t drain_requested = 0, interrupted = 0;

/// Double buffer: one text may be written while a signal handler prints the other.
struct InterruptMessage {
  std::array<char, 300> text;
  std::size_t bytes;
};
std::array<InterruptMessage, 2> interrupt_messages;
std::atomic<const InterruptMessage*> current_message{nullptr};
static_assert(std::atomic<const InterruptMessage*>::is_always_lock_free);

void note(int) { drain_requested = 1; }

void note_interrupt(int signal) {
  drain_requested = 1;
  if (interrupted == 0) {
    interrupted = 1;
    return;
  }
  const InterruptMessage* const words = current_message;
  if (words != nullptr && ::write(STDERR_FILENO, words->text.data(), words->bytes) < 0) {
    // A failed write is ignored; the process ends anyway.
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);  // takes effect when this handler returns
}

void watch(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  if (::sigaction(signal, &action, nullptr) != 0) throw std::runtime_error("sigaction failed");
}

}  // namespace

void install_drain_handlers() {
  watch(SIGUSR1, note);
  watch(SIGTERM, note);
  watch(SIGINT, note_interrupt);
}

void set_interrupt_message(std::string_view line) {
  InterruptMessage& next = current_message == interrupt_messages.data() ? interrupt_messages[1] : interrupt_messages[0];
  next.bytes = std::min(line.size(), next.text.size());
  std::copy_n(line.begin(), next.bytes, next.text.begin());
  current_message = &next;
}

bool is_drain_requested() { return drain_requested != 0; }

void end_if_mpirun_dies() {
  if (std::getenv("OMPI_COMM_WORLD_RANK") == nullptr) return;
  const pid_t parent = ::getppid();
  if (::prctl(PR_SET_PDEATHSIG, SIGKILL) != 0) throw std::runtime_error("prctl(PR_SET_PDEATHSIG) failed");
  if (::getppid() != parent) ::raise(SIGKILL);  // the parent died before the call of prctl
}

}  // namespace gigabake
