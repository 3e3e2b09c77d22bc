/// HDF5's identifiers of our element types.
#pragma once

#include <cstdint>

#include "format/shard/hdf5/hdf5_file.h"

namespace gigabake {

inline constexpr int lz4_filter = 32004;  ///< as The HDF Group registered it

/// Borrowed from the library: never closed.
std::int64_t hdf5_type(Hdf5Type type);

}  // namespace gigabake
