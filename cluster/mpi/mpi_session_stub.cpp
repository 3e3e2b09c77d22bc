// MpiSession of a build without MPI (-DGIGABAKE_MPI=OFF): a world of one rank.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <stdexcept>
#include <unistd.h>
#include <utility>

#include "cluster/mpi/mpi_session.h"
#include "cluster/mpi/mpi_version.h"
#include "cluster/process/host_cores.h"

namespace gigabake {

struct MpiSession::Outbox {};
struct MpiSession::Inbox {};

MpiSession::MpiSession() {
  const HostLimits limits = host_limits();
  const std::array own{cores_of_this_process()};
  cores_ = std::min({fair_share(own, 0), std::max(1, limits.shared_cores), limits.task_cores});
}

MpiSession::~MpiSession() = default;

int MpiSession::host_cores() const {
  return std::min(host_limits().shared_cores, int(std::max<long>(1, ::sysconf(_SC_NPROCESSORS_ONLN))));
}

void MpiSession::send(int, int, std::vector<std::uint8_t>) { throw std::logic_error("there is no other rank"); }
void MpiSession::progress() {}
std::optional<Message> MpiSession::poll() { return std::nullopt; }
std::int64_t MpiSession::max_of(std::int64_t value) { return value; }
std::int64_t MpiSession::sum_of(std::int64_t value) { return value; }
int MpiSession::from_master(int value) { return value; }
std::vector<std::uint8_t> MpiSession::from_master(std::vector<std::uint8_t> bytes) { return bytes; }
void MpiSession::abort(int exit_code) { std::_Exit(exit_code); }

bool has_mpi() { return false; }
std::string mpi_version() { return ""; }

}  // namespace gigabake
