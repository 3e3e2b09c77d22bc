#include "cluster/drain.h"

#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <sys/prctl.h>
#include <unistd.h>

namespace gigabake {
namespace {

volatile std::sig_atomic_t drain_asked = 0;

void note(int) { drain_asked = 1; }

void watch(int signal, int flags) {
  struct sigaction action {};
  action.sa_handler = note;
  action.sa_flags = SA_RESTART | flags;
  if (::sigaction(signal, &action, nullptr) != 0) throw std::runtime_error("sigaction failed");
}

}  // namespace

void watch_for_drain() {
  watch(SIGUSR1, 0);
  watch(SIGTERM, 0);
  watch(SIGINT, SA_RESETHAND);
}

bool is_drain_asked() { return drain_asked != 0; }

void end_with_mpirun() {
  if (std::getenv("OMPI_COMM_WORLD_RANK") == nullptr) return;
  const pid_t parent = ::getppid();
  if (::prctl(PR_SET_PDEATHSIG, SIGKILL) != 0) throw std::runtime_error("prctl(PR_SET_PDEATHSIG) failed");
  if (::getppid() != parent) ::raise(SIGKILL);  // it died before the line above
}

}  // namespace gigabake
