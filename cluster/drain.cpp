#include "cluster/drain.h"

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

volatile std::sig_atomic_t drain_asked = 0, interrupted = 0;

/// Double buffer: one text may be written while a signal handler prints the other.
struct LastWords {
  std::array<char, 300> text;
  std::size_t bytes;
};
std::array<LastWords, 2> last_words;
std::atomic<const LastWords*> current_words{nullptr};
static_assert(std::atomic<const LastWords*>::is_always_lock_free);

void note(int) { drain_asked = 1; }

void note_interrupt(int signal) {
  drain_asked = 1;
  if (interrupted == 0) {
    interrupted = 1;
    return;
  }
  const LastWords* const words = current_words;
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

void watch_for_drain() {
  watch(SIGUSR1, note);
  watch(SIGTERM, note);
  watch(SIGINT, note_interrupt);
}

void set_last_words(std::string_view line) {
  LastWords& next = current_words == last_words.data() ? last_words[1] : last_words[0];
  next.bytes = std::min(line.size(), next.text.size());
  std::copy_n(line.begin(), next.bytes, next.text.begin());
  current_words = &next;
}

bool is_drain_asked() { return drain_asked != 0; }

void end_with_mpirun() {
  if (std::getenv("OMPI_COMM_WORLD_RANK") == nullptr) return;
  const pid_t parent = ::getppid();
  if (::prctl(PR_SET_PDEATHSIG, SIGKILL) != 0) throw std::runtime_error("prctl(PR_SET_PDEATHSIG) failed");
  if (::getppid() != parent) ::raise(SIGKILL);  // the parent died before the call of prctl
}

}  // namespace gigabake
