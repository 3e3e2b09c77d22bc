#include "cluster/process/host_cores.h"

#include <algorithm>
#include <cmath>

namespace gigabake {

int fair_share(std::span<const CoreSet> of_ranks, std::size_t rank) {
  constexpr double rounding = 1e-6;  // tolerance for a sum of up to 1024 fractions
  double share = 0;
  for (std::size_t c = 0; c < CoreSet().size(); ++c) {
    if (!of_ranks[rank][c]) continue;
    share += 1.0 / double(std::count_if(of_ranks.begin(), of_ranks.end(), [c](const CoreSet& s) { return s[c]; }));
  }
  return std::max(1, int(std::floor(share + rounding)));
}

}  // namespace gigabake
