/// A folder that appears atomically: it is written under a temporary name, flushed, and renamed to its final name.
#pragma once

#include <filesystem>

#include "format/system/descriptor.h"

namespace gigabake {

/// The folder that may exist at the target: only an empty folder, or any folder. The existing folder is removed after
/// the new folder has replaced it.
enum class Replaces { nothing, a_folder };

/// The owner of a temporary folder. Unless publish() succeeds, the destructor removes the temporary folder.
class FolderPublication {
 public:
  /// Removes temporary folders of the target that killed processes left.
  /// Errors  InputError if the target exists and may not be replaced, or if the folder that contains the target is not
  ///         writable.
  explicit FolderPublication(std::filesystem::path target, Replaces replaces = Replaces::nothing);
  ~FolderPublication();
  FolderPublication(const FolderPublication&) = delete;
  FolderPublication& operator=(const FolderPublication&) = delete;

  /// Returns an empty temporary folder next to the target.
  const std::filesystem::path& temporary() const { return temporary_; }
  const std::filesystem::path& target() const { return target_; }

  /// Flushes the file system once, independent of the number of files, and renames the folder. A replaced folder is
  /// exchanged with the new one atomically if the file system supports it; otherwise the target is missing for a
  /// moment.
  /// Errors  InputError with the path and the system's reason.
  void publish();

 private:
  bool swap_in() const;

  std::filesystem::path target_, temporary_;
  Descriptor lock_;  ///< shows other processes that the temporary folder has an owner
  Replaces replaces_;
  bool published_ = false;
};

}  // namespace gigabake
