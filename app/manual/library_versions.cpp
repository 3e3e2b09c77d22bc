#include "app/manual/library_versions.h"

#include <hdf5.h>
#include <libdeflate.h>
#include <lz4.h>
#include <png.h>

namespace gigabake {

LibraryVersions library_versions() {
  unsigned major = 0, minor = 0, release = 0;
  H5get_libversion(&major, &minor, &release);
  LibraryVersions v;
  v.linked = {{"HDF5", std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(release)},
              {"LZ4", LZ4_versionString()},
              {"libdeflate", LIBDEFLATE_VERSION_STRING},
              {"libpng", png_get_libpng_ver(nullptr)}};
  v.loaded = {{"GDAL", GIGABAKE_GDAL}, {"OpenVDB", GIGABAKE_OPENVDB}};
  v.codecs = GIGABAKE_OPTIONAL;
  if (!v.codecs.empty()) v.codecs.erase(0, 1);
  return v;
}

}  // namespace gigabake
