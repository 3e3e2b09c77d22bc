/// A scratch file that is published atomically: readers see the whole file or none.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "format/system/descriptor.h"
#include "format/system/publish.h"

namespace gigabake {

/// Writer of one scratch file.
/// Errors  Every member throws IoError with the file and the system's reason; the incomplete file is then removed.
class ScratchPublication {
 public:
  /// Creates a temporary file in the folder of `target`, and the folder if it is missing.
  explicit ScratchPublication(std::filesystem::path target);
  /// Checks the free space before the first byte is written, so that a large file does not fail halfway.
  /// Errors  IoError: the disk has less than `bytes` of free space.
  void expect_room(std::uint64_t bytes) const;
  /// Appends the bytes and returns their offset in the file.
  std::uint64_t append(std::span<const std::uint8_t> bytes);
  /// Writes at any offset; gaps read as 0. Must not be combined with append().
  void put(std::uint64_t offset, std::span<const std::uint8_t> bytes);
  /// Publishes the file without flushing it to disk: after a power failure it may be truncated. Readers then reject the
  /// file, and it is made again.
  void publish();

 private:
  std::filesystem::path target_;
  Publication publication_;
  Descriptor file_;
  std::uint64_t bytes_ = 0;
};

/// Creates the folder and its parents.
/// Errors  IoError: the folder cannot be made.
void make_scratch_folder(const std::filesystem::path& folder);

/// Exclusive file lock for making one scratch file, released at the end of the scope. Other ranks that need the same
/// file wait for the lock. The system releases the lock if the process dies.
class ScratchLock {
 public:
  explicit ScratchLock(std::filesystem::path file);

 private:
  Descriptor lock_;
};

/// Returns the content of a scratch file, and makes the file if it is missing. One rank makes it while the others wait.
/// `find` returns the content, or null if the file does not exist. `make` writes the file and returns its content.
template <class Find, class Make>
auto find_or_make(const std::filesystem::path& file, const Find& find, const Make& make) -> decltype(find()) {
  if (auto found = find()) return found;
  make_scratch_folder(file.parent_path());
  const ScratchLock turn(file);
  if (auto found = find()) return found;
  return make();
}

}  // namespace gigabake
