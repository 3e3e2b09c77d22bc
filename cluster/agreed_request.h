/// The one request that all ranks of a launch bake.
#pragma once

#include <string>
#include <vector>

#include "cluster/bake.h"
#include "cluster/mpi_session.h"

namespace gigabake {

/// An option as messages name it, and its value as text.
struct NamedOption {
  std::string name, value;
};

/// Collective. Errors  CollectiveUsageError: a rank has another value than rank 0; names the first such option.
void expect_same_options(MpiSession& mpi, const std::vector<NamedOption>& own);

/// Collective. Returns rank 0's request with this rank's own threads, memory, devices and scratch folder. The source
/// and OUT of several ranks are absolute: ranks may have different working directories.
/// Errors  CollectiveUsageError: a rank was given another source, OUT or option on which results depend.
BakeRequest agreed_request(MpiSession& mpi, const BakeRequest& own);

}  // namespace gigabake
