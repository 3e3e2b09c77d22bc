#include "format/export/voxel_tiles/gzip_pack.h"

#include <libdeflate.h>
#include <new>

namespace gigabake {

GzipPacker::GzipPacker() : packer_(libdeflate_alloc_compressor(6)) {
  if (packer_ == nullptr) throw std::bad_alloc();
}

GzipPacker::~GzipPacker() { libdeflate_free_compressor(packer_); }

std::span<const std::uint8_t> GzipPacker::packed(std::span<const std::uint8_t> bytes) {
  const std::size_t bound = libdeflate_gzip_compress_bound(packer_, bytes.size());
  if (out_.size() < bound) out_.resize(bound);
  return {out_.data(), libdeflate_gzip_compress(packer_, bytes.data(), bytes.size(), out_.data(), out_.size())};
}

}  // namespace gigabake
