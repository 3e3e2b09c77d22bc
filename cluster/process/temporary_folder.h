/// A temporary folder, removed with its content.
#pragma once

#include <filesystem>

#include "format/system/descriptor.h"

namespace gigabake {

class TemporaryFolder {
 public:
  /// Creates a folder; also removes those that killed processes left. in: the parent folder; empty: the system's
  /// temporary folder.
  /// Errors  InputError: the folder cannot be created.
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
