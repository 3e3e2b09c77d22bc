/// The libraries that read and write files, by name and version.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace gigabake {

struct LibraryVersions {
  /// HDF5, LZ4 and libpng: version at run time. libdeflate: version at build time.
  std::vector<std::pair<std::string, std::string>> linked;
  /// Libraries that are loaded on demand (format/system/module.h): version at build time; empty if gigabake was built
  /// without the library.
  std::vector<std::pair<std::string, std::string>> loaded;
  std::string codecs;  ///< codecs of sources in this build: "zip draco meshopt webp"
};

LibraryVersions library_versions();

}  // namespace gigabake
