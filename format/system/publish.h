/// A file that appears atomically: it is written under a temporary name, flushed, and renamed to its final name.
#pragma once

#include <filesystem>
#include <string_view>

#include "format/system/descriptor.h"

namespace gigabake {

/// Durability of a published file after a power loss. Readers never see a partial file in either case.
enum class Durability { across_power_loss, while_up };

/// The treatment of temporary files of the same target that killed processes left. Removal lists the target's folder,
/// so it is for single files that a user names, not for shards.
enum class Leftovers { keep, remove };

/// The owner of a temporary file. Unless publish() succeeds, the destructor removes the temporary file.
class Publication {
 public:
  /// Errors  InputError if the target's folder is missing or not writable.
  explicit Publication(std::filesystem::path target, Leftovers leftovers = Leftovers::keep);
  ~Publication();
  Publication(const Publication&) = delete;
  Publication& operator=(const Publication&) = delete;

  /// Returns the temporary file, which exists and is empty. It is in the target's folder, so that the rename is atomic.
  const std::filesystem::path& temporary() const { return temporary_; }

  /// Calls fsync, renames the file over the target, and calls fsync on the folder; Durability::while_up only renames.
  /// Errors  InputError with the path and the system's reason.
  void publish(Durability durability = Durability::across_power_loss);

 private:
  std::filesystem::path target_, temporary_;
  Descriptor lock_;  ///< with Leftovers::remove, shows other processes that `temporary_` has an owner
  bool published_ = false;
};

/// Publishes a small file in one call.
/// Errors  InputError if the file cannot be written or renamed.
void publish_file(const std::filesystem::path& target, std::string_view content,
                  Durability durability = Durability::across_power_loss, Leftovers leftovers = Leftovers::keep);

/// Flushes all data of the file system that contains a folder. For thousands of files this is cheaper than flushing
/// each file.
/// Errors  InputError if the folder cannot be opened, or the flush fails.
void flush_file_system_of(const std::filesystem::path& folder);

}  // namespace gigabake
