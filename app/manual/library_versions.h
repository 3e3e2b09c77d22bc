/// The libraries that read and write files, by name and version.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace gigabake {

struct LibraryVersions {
  std::vector<std::pair<std::string, std::string>> linked;  ///< HDF5, LZ4, libpng: as they run; libdeflate: as built
  std::vector<std::pair<std::string, std::string>>
      loaded;          ///< when they are needed (format/system/module.h): as they were
                       ///< built with; a version is empty where it was without
  std::string codecs;  ///< of sources, that this build has: "zip draco meshopt webp"
};

LibraryVersions library_versions();

}  // namespace gigabake
