/// Name and version of the MPI library.
#pragma once

#include <string>

namespace gigabake {

/// Returns, for example, "Open MPI v4.1.4". Needs no MpiSession.
std::string mpi_version();

}  // namespace gigabake
