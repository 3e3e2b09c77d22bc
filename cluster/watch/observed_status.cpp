#include "cluster/watch/observed_status.h"

#include <cerrno>
#include <csignal>

#include "cluster/bake/status_feed.h"
#include "cluster/mpi/collective.h"
#include "cluster/process/folder_lock.h"

namespace gigabake {
namespace {

constexpr double silence_s = 15;

/// Returns true if the process that writes the status runs on this host. A process on another host cannot be checked.
bool writer_is_alive(const BakeStatus& s) {
  return s.host == host_name() && s.pid > 0 && (::kill(pid_t(s.pid), 0) == 0 || errno == EPERM);
}

/// Returns true if the process that writes the status seems to be dead. On this host, the process is checked; on
/// another host, only a timeout shows it.
bool seems_interrupted(const BakeStatus& s, const std::filesystem::path& out, double now_s) {
  if (is_over(s.state) || writer_is_alive(s) || lock_holder(out)) return false;
  return s.host == host_name() || now_s - s.updated_s > silence_s;
}

}  // namespace

ObservedStatus observe_status(const std::filesystem::path& out) {
  ObservedStatus seen{read_status(out), unix_now_s(), false};
  if (!seems_interrupted(seen.status, out, seen.now_s)) return seen;
  seen.status = read_status(out);  // reread, because the bake may have ended since the first read
  seen.interrupted = seems_interrupted(seen.status, out, seen.now_s);
  return seen;
}

}  // namespace gigabake
