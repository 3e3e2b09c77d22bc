/// The identifiers of the HDF5 types that correspond to Hdf5Type.
#pragma once

#include <cstdint>

#include "format/shard/hdf5/hdf5_file.h"

namespace gigabake {

inline constexpr int lz4_filter = 32004;  ///< number registered by The HDF Group

/// Returns the identifier of a predefined HDF5 type. HDF5 owns the type, so the caller must not close it.
std::int64_t hdf5_type(Hdf5Type type);
/// Returns the type of the dataset's items: elements, or arrays if the column has BytePlanes::of_rows. The caller must
/// not close it, because columns share types.
std::int64_t hdf5_type(const Hdf5Call& call, const Hdf5Column& column);

}  // namespace gigabake
