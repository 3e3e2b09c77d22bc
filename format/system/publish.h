/// A file that appears whole or not at all: written aside, flushed, renamed into place.
#pragma once

#include <filesystem>
#include <string_view>

namespace gigabake {

/// Whether a published file outlives a loss of power. Readers never see half a file while the machine is up.
enum class Durability { across_power_loss, while_up };

/// Holds the name to write to. Unless publish() succeeds, the destructor removes what was written there.
class Publication {
 public:
  /// Errors  InputError when the target's folder is missing or cannot be written.
  explicit Publication(std::filesystem::path target);
  ~Publication();
  Publication(const Publication&) = delete;
  Publication& operator=(const Publication&) = delete;

  /// In the target's folder, so that the rename is atomic; exists and is empty.
  const std::filesystem::path& aside() const { return aside_; }

  /// fsync, rename over the target, fsync the folder; while_up: the rename alone.
  /// Errors  InputError: path and the system's reason.
  void publish(Durability durability = Durability::across_power_loss);

 private:
  std::filesystem::path target_, aside_;
  bool published_ = false;
};

/// Publishes a small file in one call. Errors  InputError.
void publish_file(const std::filesystem::path& target, std::string_view content,
                  Durability durability = Durability::across_power_loss);

/// Flushes all that was written to the file system of a folder: for thousands of files cheaper than a flush for each.
/// Errors  InputError.
void flush_file_system_of(const std::filesystem::path& folder);

}  // namespace gigabake
