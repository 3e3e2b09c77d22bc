#include "format/shard/hdf5/file_image.h"

#include <algorithm>
#include <new>
#include <stdexcept>
#include <utility>

namespace gigabake {

std::span<const std::uint8_t> FileImage::file() const {
  // Byte offsets in an HDF5 superblock of version 2 or 3: of the version number and of the 64-bit end-of-file address.
  constexpr std::size_t version_at = 8, end_at = 28, superblock_bytes = 48;
  if (length_ < superblock_bytes || bytes_[version_at] < 2) throw std::logic_error("no HDF5 file was made in memory");
  std::uint64_t end = 0;
  for (std::size_t i = 0; i < 8; ++i) end |= std::uint64_t(bytes_[end_at + i]) << 8 * i;
  if (end > length_) throw std::logic_error("an HDF5 file in memory is longer than its memory");
  return {bytes_.get(), std::size_t(end)};
}

void* FileImage::grow(std::size_t bytes) noexcept {
  if (bytes > buffer_) {
    const std::size_t buffer = std::max(bytes, buffer_ + buffer_ / 2);
    std::unique_ptr<std::uint8_t[]> larger(new (std::nothrow) std::uint8_t[buffer]);
    if (!larger) return nullptr;
    std::copy_n(bytes_.get(), length_, larger.get());
    bytes_ = std::move(larger);
    buffer_ = buffer;
  }
  if (bytes > length_) std::fill_n(bytes_.get() + length_, bytes - length_, std::uint8_t(0));
  length_ = bytes;
  return bytes_.get();
}

}  // namespace gigabake
