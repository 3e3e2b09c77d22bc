/// Bytes of a source, in memory or still in their file: whoever reads them need not know which.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "format/system/readable_file.h"

namespace gigabake {

/// A value: copies and parts share what they look at, and keep it.
class SourceBytes {
 public:
  SourceBytes() = default;
  explicit SourceBytes(std::vector<std::uint8_t> bytes);
  explicit SourceBytes(std::shared_ptr<const ReadableFile> file);

  std::uint64_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  /// Where they begin in the file, for messages.
  std::uint64_t begin() const { return begin_; }

  /// Errors  std::out_of_range of this and the next: who asks has not checked. What a file says is checked before.
  SourceBytes part(std::uint64_t offset, std::uint64_t bytes) const;
  /// Where they are in memory, or read into `room`, which must live as long as what is returned.
  /// Errors  also as ReadableFile::read().
  std::span<const std::uint8_t> look(std::uint64_t offset, std::uint64_t bytes, std::vector<std::uint8_t>& room) const;

  std::vector<std::uint8_t> copy() const;
  /// The same bytes in memory.
  SourceBytes in_memory() const { return file_ ? SourceBytes(copy(), begin_) : *this; }
  /// Of bytes in memory.
  std::span<const std::uint8_t> span() const;

  /// All of them in their order, in blocks of at most `block_bytes`.
  void for_each_block(std::size_t block_bytes, const std::function<void(std::span<const std::uint8_t>)>& visit) const;

 private:
  SourceBytes(std::vector<std::uint8_t> bytes, std::uint64_t begin);

  std::shared_ptr<const std::vector<std::uint8_t>> memory_;
  std::shared_ptr<const ReadableFile> file_;
  std::uint64_t begin_ = 0, size_ = 0;
  std::uint64_t memory_begin_ = 0;  ///< of the file, what memory_ begins with
};

/// Large enough that asking the system costs nothing beside the copying, small enough for a processor's cache.
inline constexpr std::size_t read_block_bytes = std::size_t(1) << 18;

}  // namespace gigabake
