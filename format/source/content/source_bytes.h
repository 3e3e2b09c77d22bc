/// Bytes of a source, in memory or still in their file, with the same interface.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "format/system/readable_file.h"

namespace gigabake {

/// A byte range with value semantics. Copies and parts share the memory or the file of the range, and keep it alive.
class SourceBytes {
 public:
  SourceBytes() = default;
  explicit SourceBytes(std::vector<std::uint8_t> bytes);
  explicit SourceBytes(std::shared_ptr<const ReadableFile> file);

  std::uint64_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  /// Returns the offset of the first byte in the file, for messages.
  std::uint64_t begin() const { return begin_; }

  /// Returns a part of the bytes.
  /// Errors  std::out_of_range: the range exceeds the bytes. The caller must check ranges that a file states.
  SourceBytes part(std::uint64_t offset, std::uint64_t bytes) const;
  /// Returns a view of the bytes. If the bytes are in a file, reads them into `buffer`, which must outlive the result.
  /// Errors  std::out_of_range: the range exceeds the bytes. Also the errors of ReadableFile::read().
  std::span<const std::uint8_t> look(std::uint64_t offset, std::uint64_t bytes,
                                     std::vector<std::uint8_t>& buffer) const;

  std::vector<std::uint8_t> copy() const;
  /// Returns the same bytes in memory.
  SourceBytes in_memory() const { return file_ ? SourceBytes(copy(), begin_) : *this; }
  /// Returns the bytes, which must be in memory.
  std::span<const std::uint8_t> span() const;

  /// Calls visit() for all bytes in their order, in blocks of at most `block_bytes`.
  void for_each_block(std::size_t block_bytes, const std::function<void(std::span<const std::uint8_t>)>& visit) const;

 private:
  SourceBytes(std::vector<std::uint8_t> bytes, std::uint64_t begin);

  std::shared_ptr<const std::vector<std::uint8_t>> memory_;
  std::shared_ptr<const ReadableFile> file_;
  std::uint64_t begin_ = 0, size_ = 0;
  std::uint64_t memory_begin_ = 0;  ///< offset in the file of the first byte of memory_
};

/// Bytes per read. Blocks of this size make system calls cheap compared with copying, and fit into a processor's cache.
inline constexpr std::size_t read_block_bytes = std::size_t(1) << 18;

}  // namespace gigabake
