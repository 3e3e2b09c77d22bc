#include "format/export/gzip_pack.h"

#include <libdeflate.h>
#include <new>

namespace gigabake {

GzipPacker::GzipPacker() : packer_(libdeflate_alloc_compressor(6)) {
  if (packer_ == nullptr) throw std::bad_alloc();
}

GzipPacker::~GzipPacker() { libdeflate_free_compressor(packer_); }

std::vector<std::uint8_t> GzipPacker::packed(std::span<const std::uint8_t> bytes) const {
  std::vector<std::uint8_t> out(libdeflate_gzip_compress_bound(packer_, bytes.size()));
  out.resize(libdeflate_gzip_compress(packer_, bytes.data(), bytes.size(), out.data(), out.size()));
  return out;
}

}  // namespace gigabake
