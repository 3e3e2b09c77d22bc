/// HDF5's access to a FileImage: a driver of HDF5's virtual file layer.
#pragma once

#include "format/shard/hdf5/file_image.h"
#include "format/shard/hdf5/hdf5_call.h"

namespace gigabake {

/// Sets the properties `access` so that a file that is created with them is in memory. `image` must outlive the file.
void set_image_driver(const Hdf5Call& call, std::int64_t access, FileImage& image);

}  // namespace gigabake
