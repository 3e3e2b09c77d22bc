/// Memory in which HDF5 makes a whole file. HDF5 serves one thread at a time: what is written to a disk or a memory of
/// pages while it does so, all other writers wait for. Made here first, the file takes HDF5 a tenth of the time, and
/// its writer hands it to the system by himself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace gigabake {

/// Kept from file to file, because to touch new memory takes longer than to fill it. Grows to the largest file.
class FileImage {
 public:
  /// The file that was made here last, once it is closed: as many bytes as it says of itself.
  /// Exact   Byte for byte what HDF5 would have written to a file.
  std::span<const std::uint8_t> file() const;

  /// What is there is the former file, and none of it shows in the next one.
  void begin_file() noexcept { length_ = 0; }
  /// Room for so many bytes of the file that was begun: with those that it has, and zeros after them, as a file of the
  /// system's has where nobody wrote. Null where there is none. For HDF5.
  void* grow(std::size_t bytes) noexcept;

 private:
  std::unique_ptr<std::uint8_t[]> bytes_;
  std::size_t room_ = 0, length_ = 0;  ///< of bytes_; as far as the file has reached
};

}  // namespace gigabake
