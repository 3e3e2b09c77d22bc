/// A temporary folder, removed with its content.
#pragma once

#include <filesystem>

#include "format/system/descriptor.h"

namespace gigabake {

class TemporaryFolder {
 public:
  /// Creates a folder in `in`, or in the system's temporary folder if `in` is empty. Also removes the folders that
  /// killed processes left there.
  /// Errors  InputError: the folder cannot be created.
  explicit TemporaryFolder(const std::filesystem::path& in = {});
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  Descriptor lock_;  ///< lock on the folder itself, which the system releases when the process ends
};

}  // namespace gigabake
