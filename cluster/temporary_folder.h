/// A folder that goes again, with all that is in it.
#pragma once

#include <filesystem>

#include "format/system/descriptor.h"

namespace gigabake {

class TemporaryFolder {
 public:
  /// Also removes what killed processes left there. in: where it is made; empty: among the system's temporary files.
  /// Errors  InputError: it cannot be made.
  explicit TemporaryFolder(const std::filesystem::path& in = {});
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  Descriptor lock_;  ///< of the folder itself: the system releases it when the process ends
};

}  // namespace gigabake
