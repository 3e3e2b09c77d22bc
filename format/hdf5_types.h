/// HDF5's identifiers of our element types.
#pragma once

#include <cstdint>

#include "format/hdf5_file.h"

namespace gigabake {

/// Borrowed from the library: never closed.
std::int64_t hdf5_type(Hdf5Type type);

}  // namespace gigabake
