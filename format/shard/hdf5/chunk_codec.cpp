#include "format/shard/hdf5/chunk_codec.h"

#include <algorithm>
#include <cstring>
#include <libdeflate.h>
#include <lz4.h>
#include <memory>
#include <new>

#include "core/codec/matches.h"
#include "format/shard/hdf5/deflate_chunk.h"

namespace gigabake {
namespace {

constexpr std::size_t block_bytes = std::size_t(1) << 20, checksum_bytes = 4;

void put_big_endian(std::vector<std::uint8_t>& out, std::uint64_t value, int bytes) {
  for (int i = bytes - 1; i >= 0; --i) out.push_back(std::uint8_t(value >> (8 * i)));
}

std::uint64_t big_endian(const std::uint8_t* p, int bytes) {
  std::uint64_t v = 0;
  for (int i = 0; i < bytes; ++i) v = v << 8 | p[i];
  return v;
}

/// Returns the Fletcher-32 checksum of `data`: sums of big-endian 16-bit words modulo 65535. An odd last byte is padded
/// with a zero byte.
std::uint32_t fletcher32(std::span<const std::uint8_t> data) {
  std::uint64_t a = 0, b = 0;
  // The sums of 65,536 words stay below 2^48. The reduction does not map 65535 to 0, like the code in HDF5.
  const auto fold = [](std::uint64_t s) {
    while (s >> 16 != 0) s = (s & 0xffff) + (s >> 16);
    return s;
  };
  const std::size_t words = data.size() / 2;
  for (std::size_t i = 0; i < words;) {
    const std::size_t end = std::min(words, i + 65536);
    for (; i < end; ++i) {
      a += std::uint64_t(data[2 * i]) << 8 | data[2 * i + 1];
      b += a;
    }
    a = fold(a);
    b = fold(b);
  }
  if (data.size() % 2 != 0) {
    a = fold(a + (std::uint64_t(data.back()) << 8));
    b = fold(b + a);
  }
  return std::uint32_t(b << 16 | a);
}

void append_block(std::vector<std::uint8_t>& out, const std::uint8_t* raw, std::size_t size) {
  const std::size_t at = out.size();
  const int bound = LZ4_compressBound(int(size));
  out.resize(at + 4 + std::size_t(bound));
  const int packed =
      LZ4_compress_default(reinterpret_cast<const char*>(raw), reinterpret_cast<char*>(&out[at + 4]), int(size), bound);
  std::size_t stored = std::size_t(packed);
  if (packed <= 0 || stored >= size) {
    stored = size;
    std::memcpy(&out[at + 4], raw, size);
  }
  for (int i = 0; i < 4; ++i) out[at + std::size_t(i)] = std::uint8_t(stored >> (8 * (3 - i)));
  out.resize(at + 4 + stored);
}

/// Decodes the first raw.size() bytes of an LZ4 block that has `size` bytes when unpacked. Returns false if it is
/// damaged.
bool decode_block(std::span<const std::uint8_t> stored, std::size_t size, std::span<std::uint8_t> raw) {
  if (stored.size() > size) return false;
  if (stored.size() == size) {
    std::memcpy(raw.data(), stored.data(), raw.size());
    return true;
  }
  const auto* from = reinterpret_cast<const char*>(stored.data());
  auto* to = reinterpret_cast<char*>(raw.data());
  const int maximum = int(raw.size());
  return maximum == (raw.size() == size ? LZ4_decompress_safe(from, to, int(stored.size()), maximum)
                                        : LZ4_decompress_safe_partial(from, to, int(stored.size()), maximum, maximum));
}

bool decode_frame(std::span<const std::uint8_t> in, std::size_t chunk_bytes, std::span<std::uint8_t> raw) {
  if (in.size() < 12 || big_endian(in.data(), 8) != chunk_bytes) return false;
  const std::size_t block = big_endian(in.data() + 8, 4);
  if (block == 0 && chunk_bytes > 0) return false;
  in = in.subspan(12);
  for (; !raw.empty(); chunk_bytes -= std::min(block, chunk_bytes)) {
    const std::size_t size = std::min(block, chunk_bytes), wanted = std::min(size, raw.size());
    if (in.size() < 4) return false;
    const std::size_t stored = big_endian(in.data(), 4);
    if (stored > in.size() - 4 || !decode_block(in.subspan(4, stored), size, raw.first(wanted))) return false;
    in = in.subspan(4 + stored);
    raw = raw.subspan(wanted);
    if (wanted < size) return true;
  }
  return chunk_bytes > 0 || in.empty();
}

std::vector<std::uint8_t> encode_frame(std::span<const std::uint8_t> raw) {
  const std::size_t block = std::min(block_bytes, raw.size());
  std::vector<std::uint8_t> out;
  put_big_endian(out, raw.size(), 8);
  put_big_endian(out, block, 4);
  for (std::size_t at = 0; at < raw.size(); at += block)
    append_block(out, raw.data() + at, std::min(block, raw.size() - at));
  return out;
}

using Decompressor = std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)>;

bool decode_zlib(std::span<const std::uint8_t> in, std::span<std::uint8_t> raw) {
  const Decompressor decompressor(libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
  if (!decompressor) throw std::bad_alloc();
  return libdeflate_zlib_decompress(decompressor.get(), in.data(), in.size(), raw.data(), raw.size(), nullptr) ==
         LIBDEFLATE_SUCCESS;
}

/// Restores the first elements of a shuffled chunk, until `raw` is full.
void unshuffle(std::span<const std::uint8_t> in, std::size_t element, std::span<std::uint8_t> raw) {
  const std::size_t elements = in.size() / element;
  for (std::size_t i = 0; i < raw.size() / element; ++i)
    for (std::size_t b = 0; b < element; ++b) raw[i * element + b] = in[b * elements + i];
}

bool unpack(std::span<const std::uint8_t> in, Codec codec, std::size_t chunk_bytes, std::span<std::uint8_t> raw) {
  if (codec == Codec::lz4) return decode_frame(in, chunk_bytes, raw);
  if (raw.size() == chunk_bytes) return decode_zlib(in, raw);
  std::vector<std::uint8_t> whole(chunk_bytes);
  if (!decode_zlib(in, whole)) return false;
  std::copy_n(whole.begin(), raw.size(), raw.begin());
  return true;
}

}  // namespace

void shuffle_chunk(std::span<const std::uint8_t> raw, std::size_t element_bytes, std::uint8_t* to) {
  if (element_bytes <= 1) {
    std::copy(raw.begin(), raw.end(), to);
    return;
  }
  // The loops have the inverse order of the loops in core/codec, so that the output is written sequentially.
  const std::size_t elements = raw.size() / element_bytes;
  for (std::size_t b = 0; b < element_bytes; ++b)
    for (std::size_t i = 0; i < elements; ++i) *to++ = raw[i * element_bytes + b];
}

std::vector<std::uint8_t> encode_chunk(std::span<const std::uint8_t> raw, const ChunkFilters& filters) {
  // The vector is kept per thread, because a new vector would be filled with zeros at each call.
  thread_local std::vector<std::uint8_t> ordered;
  ordered.resize(std::max(ordered.size(), raw.size() + deflate::readable_beyond));
  shuffle_chunk(raw, filters.shuffled_bytes, ordered.data());
  const std::span<const std::uint8_t> bytes(ordered.data(), raw.size());
  std::vector<std::uint8_t> out =
      filters.codec == Codec::lz4 ? encode_frame(bytes) : zlib_frame(bytes, filters.min_match_bytes, checksum_bytes);
  const std::uint32_t sum = fletcher32(out);
  for (int i = 0; i < 4; ++i) out.push_back(std::uint8_t(sum >> (8 * i)));
  return out;
}

bool has_valid_checksum(std::span<const std::uint8_t> stored) {
  if (stored.size() < 4) return false;
  const auto packed = stored.first(stored.size() - 4);
  std::uint32_t sum = 0;
  for (int i = 0; i < 4; ++i) sum |= std::uint32_t(stored[packed.size() + std::size_t(i)]) << (8 * i);
  return fletcher32(packed) == sum;
}

bool decode_chunk(std::span<const std::uint8_t> stored, const ChunkFilters& filters, std::size_t chunk_bytes,
                  std::span<std::uint8_t> raw) {
  if (!has_valid_checksum(stored)) return false;
  const auto packed = stored.first(stored.size() - 4);
  if (filters.shuffled_bytes <= 1) return unpack(packed, filters.codec, chunk_bytes, raw);
  std::vector<std::uint8_t> shuffled(chunk_bytes);
  if (!unpack(packed, filters.codec, chunk_bytes, shuffled)) return false;
  unshuffle(shuffled, filters.shuffled_bytes, raw);
  return true;
}

}  // namespace gigabake
