#include "cluster/host_cores.h"

#include <algorithm>
#include <cmath>
#include <sched.h>
#include <thread>

namespace gigabake {

CoreSet cores_of_this_process() {
  CoreSet cores;
  cpu_set_t set;
  CPU_ZERO(&set);
  if (::sched_getaffinity(0, sizeof set, &set) == 0) {
    for (std::size_t c = 0; c < cores.size(); ++c) cores[c] = CPU_ISSET(c, &set);
  } else {  // a kernel with more cores than the set holds
    for (std::size_t c = 0; c < std::min<std::size_t>(std::thread::hardware_concurrency(), cores.size()); ++c)
      cores.set(c);
  }
  return cores;
}

int fair_share(std::span<const CoreSet> of_ranks, std::size_t rank) {
  constexpr double rounding = 1e-6;  // of a sum of up to 1024 fractions
  double share = 0;
  for (std::size_t c = 0; c < CoreSet().size(); ++c) {
    if (!of_ranks[rank][c]) continue;
    share += 1.0 / double(std::count_if(of_ranks.begin(), of_ranks.end(), [c](const CoreSet& s) { return s[c]; }));
  }
  return std::max(1, int(std::floor(share + rounding)));
}

}  // namespace gigabake
