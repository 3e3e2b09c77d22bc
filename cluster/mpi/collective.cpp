#include "cluster/mpi/collective.h"

#include <unistd.h>

namespace gigabake {

std::string host_name() {
  char name[256] = {};
  return ::gethostname(name, sizeof name - 1) == 0 ? name : "an unnamed host";
}

void fail_collectively(MpiSession& mpi, const std::optional<std::string>& line, bool is_stopped) {
  const int weight = mpi.ranks() - mpi.rank();  // the lowest rank with a line has the max weight
  const int stop_weight = mpi.ranks() + 1;
  const std::int64_t heaviest = mpi.max_of(is_stopped ? stop_weight : line ? weight : 0);
  if (heaviest == 0) return;
  if (heaviest == stop_weight) throw Stopped();
  if (heaviest != weight) throw CollectiveFailure("");
  const std::string who = " (rank " + std::to_string(mpi.rank()) + " on " + host_name() + ")";
  throw CollectiveFailure(mpi.rank() == 0 ? *line : *line + who);
}

}  // namespace gigabake
