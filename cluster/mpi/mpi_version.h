/// Name and version of the MPI library.
#pragma once

#include <string>

namespace gigabake {

/// Returns false if gigabake was built without MPI; each MpiSession then has one rank.
bool has_mpi();

/// Returns, for example, "Open MPI v4.1.4"; empty without MPI. Needs no MpiSession.
std::string mpi_version();

}  // namespace gigabake
