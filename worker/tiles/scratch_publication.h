/// A scratch file that is written from its begin to its end, and appears whole or not at all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "format/system/descriptor.h"
#include "format/system/publish.h"

namespace gigabake {

/// Errors  IoError of every member: the file and the system's reason; what was written is gone.
class ScratchPublication {
 public:
  /// Makes the folder where it is missing.
  explicit ScratchPublication(std::filesystem::path target);
  /// Errors  Already where the disk has less room than so many bytes: what would end half-way is not begun.
  void expect_room(std::uint64_t bytes) const;
  /// The offset at which they stand.
  std::uint64_t append(std::span<const std::uint8_t> bytes);
  /// Anywhere; what nothing was put to is 0. Not to be mixed with append().
  void put(std::uint64_t offset, std::span<const std::uint8_t> bytes);
  /// Not flushed: after a loss of power it may be cut, and is made again.
  void publish();

 private:
  std::filesystem::path target_;
  Publication publication_;
  Descriptor file_;
  std::uint64_t bytes_ = 0;
};

/// Errors  IoError: the folder cannot be made.
void make_scratch_folder(const std::filesystem::path& folder);

/// The right to make a file, held until it goes out of scope: other ranks that want the same file wait. A process that
/// dies lets go of it.
class ScratchTurn {
 public:
  explicit ScratchTurn(std::filesystem::path file);

 private:
  Descriptor lock_;
};

/// What a scratch file holds: found, or made by the one whose turn it is while the others wait.
/// find: null where the file is not there. make: writes it.
template <class Find, class Make>
auto found_or_made(const std::filesystem::path& file, const Find& find, const Make& make) -> decltype(find()) {
  if (auto found = find()) return found;
  make_scratch_folder(file.parent_path());
  const ScratchTurn turn(file);
  if (auto found = find()) return found;
  return make();
}

}  // namespace gigabake
