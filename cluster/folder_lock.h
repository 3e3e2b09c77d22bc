/// One bake at a time in a folder.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "format/system/descriptor.h"

namespace gigabake {

/// Holds FOLDER/.lock, which names host, process and start, and removes it in the end. A file that another member of
/// the folder's group left is taken over. When the process is killed the system lets go of the lock, and the file that
/// stays means nothing. Range   An open file description lock: also between hosts on NFS 4, on NFS 3 with its lock
/// daemon, and on Lustre
///         with the mount option flock.
class FolderLock {
 public:
  /// Waits for a holder of this host that was killed and has not ended yet: up to half a minute. A holder that cannot
  /// be seen from here is not waited for. Errors  InputError: somebody else holds it, and who; or the file system
  /// cannot lock.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  std::filesystem::path path_;
  Descriptor file_;
};

/// Who bakes into the folder now, as "process 12 on HOST since 2025-01-31T12:00:00Z"; nothing where nobody does.
std::optional<std::string> lock_holder(const std::filesystem::path& folder);

}  // namespace gigabake
