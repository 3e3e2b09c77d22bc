/// A folder that appears whole or not at all: written aside, flushed, renamed into place.
#pragma once

#include <filesystem>

namespace gigabake {

/// What may stand at the target: nothing, or also a folder, which is gone once the new one stands there.
enum class Replaces { nothing, a_folder };

/// Unless publish() succeeds, the destructor removes what was written to aside().
class FolderPublication {
 public:
  /// Errors  InputError: at the target is what may not be there, or its folder cannot be written.
  explicit FolderPublication(std::filesystem::path target, Replaces replaces = Replaces::nothing);
  ~FolderPublication();
  FolderPublication(const FolderPublication&) = delete;
  FolderPublication& operator=(const FolderPublication&) = delete;

  /// An empty folder beside the target.
  const std::filesystem::path& aside() const { return aside_; }
  const std::filesystem::path& target() const { return target_; }

  /// Flushes the file system once, however many files there are, and renames. A folder that is replaced changes places
  /// with the new one in one step, where the file system knows how; elsewhere its name is free for a moment.
  /// Errors  InputError: path and the system's reason.
  void publish();

 private:
  bool swap_in() const;

  std::filesystem::path target_, aside_;
  Replaces replaces_;
  bool published_ = false;
};

}  // namespace gigabake
