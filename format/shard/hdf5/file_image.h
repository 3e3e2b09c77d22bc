/// A file in memory, as the list of HDF5's writes. HDF5 serializes its calls, so all other writers wait while one call
/// writes to a file. A write to this list takes a tenth of the time, and packed chunks are not even copied. The writer
/// passes the bytes to the system outside of HDF5.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "format/system/descriptor.h"

namespace gigabake {

/// The memory of the chunks that are written to a file in memory.
enum class ChunkMemory : std::uint8_t {
  copied,
  referred,  ///< the caller keeps the chunks until the file is written to disk
};

/// A list that is reused for each next file, because the first access to new memory takes longer than filling it.
class FileImage {
 public:
  /// Writes the last file that was built in this list to an empty file on disk. Returns false on failure; errno has the
  /// reason, and a part may have been written.
  /// Range   The file was closed, and the chunks that it refers to still exist.
  /// Exact   Same bytes as HDF5 would write to a file on disk.
  bool write_to(const Descriptor& file) const;

  // The next members are for HDF5's driver (image_driver.h).

  /// Starts a new file. It contains no bytes of the previous file.
  void begin_file() noexcept;
  /// Applies to the next chunks that are written.
  void set_chunk_memory(ChunkMemory chunks) noexcept { chunks_ = chunks; }
  /// Records a write. `is_chunk` is true for stored chunks, and false for HDF5's metadata.
  void write(std::uint64_t at, const std::uint8_t* bytes, std::size_t count, bool is_chunk);
  /// Reads bytes that were written; all other bytes are 0.
  void read(std::uint64_t at, std::uint8_t* bytes, std::size_t count) const;
  /// Returns the address of the chunk that was written last.
  std::uint64_t last_chunk() const noexcept { return last_chunk_; }
  void set_length(std::uint64_t bytes) noexcept { length_ = bytes; }
  std::uint64_t length() const noexcept { return length_; }

 private:
  struct Piece {
    std::uint64_t at;
    std::size_t count;
    const std::uint8_t* referred;  ///< null: the bytes are in copied_
    std::size_t copied_at;
    std::uint64_t end() const { return at + count; }
  };

  const std::uint8_t* bytes_of(const Piece& piece) const {
    return piece.referred != nullptr ? piece.referred : copied_.data() + piece.copied_at;
  }
  bool write_run(const Descriptor& file, const Piece* pieces, std::size_t count) const;

  std::vector<Piece> pieces_;  ///< in the order of the writes; a later write replaces the bytes of an earlier one
  std::vector<std::uint8_t> copied_;
  std::uint64_t length_ = 0, last_chunk_ = 0;
  ChunkMemory chunks_ = ChunkMemory::copied;
};

}  // namespace gigabake
