// Writes the bytes of stored chunks from tokens and codes.
#include "kernels/pack/batch.cuh"

namespace gigabake::kernels::pack {
namespace {

constexpr unsigned warps = 8, summers = 256;
/// The max number of words that 32 tokens occupy if they begin at any bit of a word.
constexpr unsigned gathered_words = 32 * 48 / 32 + 2;

/// Sets bits of a word that are still zero. The operation is atomic, because other warps may set other bits of the same
/// word.
__device__ void set_bits(std::uint32_t* words, std::uint32_t word, std::uint32_t bits) {
  if (bits != 0) atomicOr(words + word, bits);
}

/// The position of a bit in the result, counted from bit 0 of words[0]. Words are little-endian: bit 0 of a word is bit
/// 0 of its first byte.
struct BitPlace {
  std::uint32_t* words;
  std::uint64_t bit;
};

__device__ BitPlace place_of(const Batch& batch, const ChunkPlace& chunk, std::uint64_t bit) {
  const std::uint64_t at = (chunk.packed + deflate::zlib_header_bytes) * 8 + bit;
  return {reinterpret_cast<std::uint32_t*>(batch.packed) + at / 32, at % 32};
}

__device__ std::uint32_t sum_upto(std::uint32_t count) {
  for (unsigned d = 1; d < 32; d *= 2) {
    const std::uint32_t lower = __shfl_up_sync(~0u, count, d);
    if (threadIdx.x % 32 >= d) count += lower;
  }
  return count;
}

/// Concatenates the bits of a warp's lanes in shared memory and writes them to `to`. Returns the number of bits.
__device__ std::uint32_t write_together(const deflate::Bits& mine, const BitPlace& to, std::uint32_t* gathered) {
  const std::uint32_t lane = threadIdx.x % 32, upto = sum_upto(mine.count);
  const std::uint32_t all = __shfl_sync(~0u, upto, 31);
  const auto within = std::uint32_t(to.bit);
  const std::uint32_t words = (within + all + 31) / 32;
  for (std::uint32_t w = lane; w < words; w += 32) gathered[w] = 0;
  __syncwarp();
  const std::uint32_t at = within + upto - mine.count, shift = at % 32;
  const std::uint64_t low = mine.bits << shift;
  const auto high = std::uint32_t(shift == 0 ? 0 : mine.bits >> (64 - shift));
  set_bits(gathered, at / 32, std::uint32_t(low));
  set_bits(gathered, at / 32 + 1, std::uint32_t(low >> 32));
  set_bits(gathered, at / 32 + 2, high);
  __syncwarp();
  for (std::uint32_t w = lane; w < words; w += 32) set_bits(to.words, w, gathered[w]);
  __syncwarp();
  return all;
}

__device__ BitPlace moved(const BitPlace& from, std::uint32_t bits) {
  const std::uint64_t bit = from.bit + bits;
  return {from.words + bit / 32, bit % 32};
}

/// Copies a part of a chunk that has stored blocks. The chunk's thread blocks copy equal parts; `block` is the number
/// of the calling thread block.
__device__ void copy_stored(const Batch& batch, const ChunkPlace& chunk, std::uint32_t block) {
  const std::uint32_t size = deflate::stored_size(chunk.bytes), share = size / chunk.blocks + 1;
  std::uint8_t* to = batch.packed + chunk.packed + deflate::zlib_header_bytes;
  for (std::uint32_t i = block * share + threadIdx.x; i < min((block + 1) * share, size); i += warps * 32)
    to[i] = deflate::stored_byte(batch.bytes + chunk.staged, chunk.bytes, i);
}

/// Writes the tokens of a segment. One warp must call this function.
__device__ void write_segment(const deflate::Token* tokens, std::uint32_t count, const deflate::Code* codes,
                              BitPlace to, std::uint32_t* gathered) {
  for (std::uint32_t t = 0; t < count; t += 32) {
    const std::uint32_t mine = t + threadIdx.x % 32;
    const deflate::Bits bits = mine < count ? deflate::bits_of(tokens[mine], codes) : deflate::Bits{0, 0};
    to = moved(to, write_together(bits, to, gathered));
  }
}

/// Writes the header and the end-of-block symbol of a block. One warp must call this function.
__device__ void write_header(const Batch& batch, const ChunkPlace& chunk, const BlockPlace& block,
                             const deflate::BlockCodes& made, std::uint32_t* gathered) {
  BitPlace to = place_of(batch, chunk, block.first_bit);
  for (std::uint32_t w = 0; 32 * w < made.header_bits; w += 32) {
    const std::uint32_t mine = w + threadIdx.x % 32;
    const std::uint32_t bits = 32 * mine < made.header_bits ? min(32u, made.header_bits - 32 * mine) : 0;
    to = moved(to, write_together({bits == 0 ? 0 : made.header[mine], bits}, to, gathered));
  }
  if (threadIdx.x % 32 != 0) return;
  const deflate::Bits end = deflate::bits_of(deflate::end_of_block, made.codes);
  to = place_of(batch, chunk, block.first_bit + block.bits - end.count);
  const std::uint64_t bits = end.bits << to.bit;
  set_bits(to.words, 0, std::uint32_t(bits));
  set_bits(to.words, 1, std::uint32_t(bits >> 32));
}

/// Writes all chunks' blocks, with one thread block per deflate block. The warps of a thread block write the segments
/// in turn.
__global__ void __launch_bounds__(warps * 32) write(Batch batch) {
  __shared__ deflate::Code codes[deflate::block_symbols];
  __shared__ std::uint32_t gathered[warps][gathered_words];
  const BlockPlace& block = batch.blocks[blockIdx.x];
  const ChunkPlace chunk = batch.chunks[block.chunk];
  if (chunk.as_is != 0) return copy_stored(batch, chunk, blockIdx.x - chunk.first_block);
  const deflate::BlockCodes& made = batch.symbols[blockIdx.x].codes;
  for (std::uint32_t s = threadIdx.x; s < deflate::block_symbols; s += warps * 32) codes[s] = made.codes[s];
  __syncthreads();
  const std::uint32_t warp = threadIdx.x / 32;
  if (warp == 0) write_header(batch, chunk, block, made, gathered[0]);
  __syncwarp();
  for (std::uint32_t s = warp; s < deflate::segments_per_block; s += warps) {
    const BitPlace to = place_of(batch, chunk, block.first_bit + made.header_bits + block.segment_bits[s]);
    write_segment(batch.words + chunk.staged + block.begin + s * deflate::segment_bytes, block.segment_tokens[s], codes,
                  to, gathered[warp]);
  }
}

/// Joins the sums of all threads of a thread block and returns the result to every thread. Begins with a barrier.
template <class Sums>
__device__ Sums joined(Sums mine) {
  __shared__ Sums all[summers];
  mine.fold();
  __syncthreads();
  all[threadIdx.x] = mine;
  __syncthreads();
  for (unsigned half = summers / 2; half > 0; half /= 2) {
    if (threadIdx.x < half) all[threadIdx.x].join(all[threadIdx.x + half]);
    __syncthreads();
  }
  return all[0];
}

/// Writes the zlib header and both checksums of each chunk, with one thread block per chunk.
__global__ void __launch_bounds__(summers) sums(Batch batch) {
  const ChunkPlace chunk = batch.chunks[blockIdx.x];
  const std::uint8_t* bytes = batch.bytes + chunk.staged;
  deflate::Adler of_bytes{};
  for (std::uint32_t i = threadIdx.x; i < chunk.bytes; i += summers) of_bytes.add(bytes[i], chunk.bytes - 1 - i);
  const std::uint32_t adler = deflate::adler32_of(joined(of_bytes), chunk.bytes);

  std::uint8_t* const packed = batch.packed + chunk.packed;
  const std::uint32_t framed = chunk.packed_bytes - deflate::checksum_bytes, i = threadIdx.x;
  if (i < deflate::zlib_header_bytes) packed[i] = deflate::zlib_header_byte(i);
  if (i < deflate::checksum_bytes) packed[framed - deflate::checksum_bytes + i] = deflate::adler_byte(adler, i);
  __syncthreads();
  deflate::Fletcher of_words{};
  const std::uint32_t words = deflate::fletcher_words(framed);
  for (std::uint32_t w = i; w < words; w += summers)
    of_words.add(deflate::fletcher_word(packed, framed, w), words - 1 - w);
  const std::uint32_t fletcher = deflate::fletcher32_of(joined(of_words));
  if (i < deflate::checksum_bytes) packed[framed + i] = deflate::fletcher_byte(fletcher, i);
}

}  // namespace

void write_blocks(const Batch& batch, cudaStream_t stream) {
  write<<<batch.block_count, warps * 32, 0, stream>>>(batch);
  check_launch("write");
}

void add_checksums(const Batch& batch, cudaStream_t stream) {
  sums<<<batch.chunk_count, summers, 0, stream>>>(batch);
  check_launch("sums");
}

}  // namespace gigabake::kernels::pack
