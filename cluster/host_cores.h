/// Which cores a rank may count on where several ranks share a host.
#pragma once

#include <cstddef>
#include <span>

#include "format/system/host_limits.h"

namespace gigabake {

/// Rank's share when each core is split evenly among the ranks that may run on it; at least 1.
/// of_ranks: of every rank on the host.
int fair_share(std::span<const CoreSet> of_ranks, std::size_t rank);

}  // namespace gigabake
