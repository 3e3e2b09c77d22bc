#include "cluster/mpi/mpi_version.h"

#include <mpi.h>

namespace gigabake {

bool has_mpi() { return true; }

std::string mpi_version() {
  char text[MPI_MAX_LIBRARY_VERSION_STRING] = "";
  int length = 0;
  if (MPI_Get_library_version(text, &length) != MPI_SUCCESS) return "MPI";
  const std::string all(text, std::size_t(length));
  return all.substr(0, all.find_first_of(",\n"));  // the rest describes the build
}

}  // namespace gigabake
