/// A folder that appears whole or not at all: written aside, flushed, renamed into place.
#pragma once

#include <filesystem>

namespace gigabake {

/// Unless publish() succeeds, the destructor removes what was written to aside().
class FolderPublication {
 public:
  /// Errors  InputError: the target is a file or a folder with something in it, or its folder cannot be written.
  explicit FolderPublication(std::filesystem::path target);
  ~FolderPublication();
  FolderPublication(const FolderPublication&) = delete;
  FolderPublication& operator=(const FolderPublication&) = delete;

  /// An empty folder beside the target.
  const std::filesystem::path& aside() const { return aside_; }
  const std::filesystem::path& target() const { return target_; }

  /// Flushes the file system once, however many files there are, and renames.
  /// Errors  InputError: path and the system's reason.
  void publish();

 private:
  std::filesystem::path target_, aside_;
  bool published_ = false;
};

}  // namespace gigabake
