/// Agreement of all ranks of a launch on one request.
#pragma once

#include <string>
#include <vector>

#include "cluster/bake/bake.h"
#include "cluster/mpi/mpi_session.h"

namespace gigabake {

/// The name of an option in messages, and the option's value as text.
struct NamedOption {
  std::string name, value;
};

/// Collective. Compares the options of all ranks.
/// Errors  CollectiveUsageError: a rank's value differs from rank 0's. The message names the first option that differs.
void expect_same_options(MpiSession& mpi, const std::vector<NamedOption>& own);

/// Collective. Returns rank 0's request with this rank's own threads, memory, devices and scratch folder. Source and
/// OUT become absolute if there are several ranks, because ranks may have different working directories.
/// Errors  CollectiveUsageError: source, OUT or an option that affects results differs between ranks.
BakeRequest agreed_request(MpiSession& mpi, const BakeRequest& own);

}  // namespace gigabake
