/// A folder that appears atomically: written to a temporary folder, flushed, renamed to its final name.
#pragma once

#include <filesystem>

namespace gigabake {

/// The entry that may exist at the target: nothing, or also a folder, which is removed after the new one replaced it.
enum class Replaces { nothing, a_folder };

/// Owns a temporary folder. Unless publish() succeeds, the destructor removes it.
class FolderPublication {
 public:
  /// Errors  InputError: the target exists and may not be replaced, or its folder is not writable.
  explicit FolderPublication(std::filesystem::path target, Replaces replaces = Replaces::nothing);
  ~FolderPublication();
  FolderPublication(const FolderPublication&) = delete;
  FolderPublication& operator=(const FolderPublication&) = delete;

  /// Returns an empty temporary folder next to the target.
  const std::filesystem::path& aside() const { return aside_; }
  const std::filesystem::path& target() const { return target_; }

  /// Flushes the file system once, independent of the number of files, and renames. A replaced folder is exchanged with
  /// the new one atomically if the file system supports it; otherwise the target is missing for a moment.
  /// Errors  InputError, naming the path and the system's reason.
  void publish();

 private:
  bool swap_in() const;

  std::filesystem::path target_, aside_;
  Replaces replaces_;
  bool published_ = false;
};

}  // namespace gigabake
