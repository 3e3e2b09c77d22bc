/// The libraries that read and write files, by name and version.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace gigabake {

struct LibraryVersions {
  std::vector<std::pair<std::string, std::string>> linked;  ///< HDF5, LZ4, libpng: run-time version; libdeflate: build
  std::vector<std::pair<std::string, std::string>>
      loaded;          ///< loaded on demand (format/system/module.h): version of the build; empty if built without
  std::string codecs;  ///< codecs of sources in this build: "zip draco meshopt webp"
};

LibraryVersions library_versions();

}  // namespace gigabake
