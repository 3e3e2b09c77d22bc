/// Memory in which HDF5 builds a whole file. HDF5 serializes its calls, so all other writers wait while one call writes
/// to a file, even to a file in memory (tmpfs). In this buffer, the calls take a tenth of the time, and the writer
/// passes the bytes to the system outside of HDF5.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace gigabake {

/// A buffer that is reused for each next file, because the first access to new memory takes longer than filling it. It
/// grows to the size of the largest file.
class FileImage {
 public:
  /// Returns the bytes of the last file that was built in this buffer. Its length is the end-of-file address in the
  /// superblock.
  /// Range   The file was closed.
  /// Exact   Same bytes as HDF5 would write to a file on disk.
  std::span<const std::uint8_t> file() const;

  /// Starts a new file. The buffer still holds the previous file, but the new file contains none of its bytes.
  void begin_file() noexcept { length_ = 0; }
  /// Sets the new file's size to `bytes` and returns its memory. Keeps the bytes that were written so far and sets new
  /// bytes to zero. Returns null if there is not enough memory. HDF5 calls this function.
  void* grow(std::size_t bytes) noexcept;

 private:
  std::unique_ptr<std::uint8_t[]> bytes_;
  std::size_t buffer_ = 0, length_ = 0;  ///< capacity of bytes_, and current size of the file
};

}  // namespace gigabake
