/// Exclusive lock of an output folder against other bakes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "format/system/descriptor.h"

namespace gigabake {

/// The owner of the lock file FOLDER/.lock, which names host, process and start time. The destructor removes the file.
/// A lock file that another member of the folder's group left is reused. If the process is killed, the system releases
/// the lock; the remaining file has no effect.
/// Range   Uses an open file description lock. It works between hosts on NFS 4, on NFS 3 with its lock daemon, and on
///         Lustre with the mount option flock.
class FolderLock {
 public:
  /// Acquires the lock. Waits up to 30 s for an owner on this host that was killed and has not yet ended. Does not wait
  /// for an owner that is not visible in /proc.
  /// Errors  InputError: another process, named in the message, holds the lock; or the file system cannot lock.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  std::filesystem::path path_;
  Descriptor file_;
};

/// Returns the current owner as "process 12 on HOST since 2025-01-31T12:00:00Z"; nullopt if there is none.
std::optional<std::string> lock_holder(const std::filesystem::path& folder);

}  // namespace gigabake
