/// Which MPI this is.
#pragma once

#include <string>

namespace gigabake {

/// "Open MPI v4.1.4". Needs no MpiSession.
std::string mpi_version();

}  // namespace gigabake
