/// Division of a host's cores among the ranks on it.
#pragma once

#include <cstddef>
#include <span>

#include "format/system/host_limits.h"

namespace gigabake {

/// Returns a rank's number of cores if each core is divided evenly among the ranks that may run on it; at least 1.
/// `of_ranks` contains the cores of every rank on the host.
int fair_share(std::span<const CoreSet> of_ranks, std::size_t rank);

}  // namespace gigabake
