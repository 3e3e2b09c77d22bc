/// Memory in which HDF5 builds a whole file. HDF5 serializes its calls, so all other writers wait while one call writes
/// to a disk or to a paged memory file. In this memory, the calls take a tenth of the time, and the writer passes the
/// bytes to the system outside of HDF5.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace gigabake {

/// Buffer reused from file to file, because touching new memory takes longer than filling it. Grows to the largest
/// file.
class FileImage {
 public:
  /// Returns the last file built here, after it was closed. The length is the end of file that the superblock states.
  /// Exact   Same bytes as HDF5 would write to a file on disk.
  std::span<const std::uint8_t> file() const;

  /// Starts a new file. The buffer still holds the previous file, but the new file contains none of its bytes.
  void begin_file() noexcept { length_ = 0; }
  /// Grows the new file to `bytes` and returns its memory. Keeps the bytes written so far and sets the rest to zero,
  /// like a sparse file. Returns null if there is not enough memory. Called by HDF5.
  void* grow(std::size_t bytes) noexcept;

 private:
  std::unique_ptr<std::uint8_t[]> bytes_;
  std::size_t buffer_ = 0, length_ = 0;  ///< capacity of bytes_; the length of the file so far
};

}  // namespace gigabake
