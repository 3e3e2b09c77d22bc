/// Which cores a rank may count on where several ranks share a host.
#pragma once

#include <bitset>
#include <cstddef>
#include <span>

namespace gigabake {

/// Bit c: core c.
using CoreSet = std::bitset<1024>;

/// Those that this process may run on: mpirun may have bound it to a few.
CoreSet cores_of_this_process();

/// Rank's share when each core is split evenly among the ranks that may run on it; at least 1.
/// of_ranks: of every rank on the host.
int fair_share(std::span<const CoreSet> of_ranks, std::size_t rank);

}  // namespace gigabake
