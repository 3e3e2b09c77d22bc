#include "format/shard/hdf5/deflate_chunk.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <libdeflate.h>
#include <memory>

#include "core/codec/block_codes.h"
#include "core/codec/matches.h"
#include "core/codec/stored_chunk.h"

namespace gigabake {
namespace {

namespace rules = deflate;

struct Workplace {
  std::array<rules::Bucket, rules::buckets> table;
  std::array<rules::Bucket, rules::segment_bytes> found;
  std::array<rules::Token, rules::block_bytes> tokens;
  std::size_t token_count = 0;
  std::uint32_t counts[rules::block_symbols];
  rules::BlockWork work;
  rules::BlockCodes codes;
  std::vector<std::uint8_t> written;
};

/// Match candidates of the positions of a segment, from one hash table over all positions of the chunk. begin_segment()
/// enters all positions of the segment before any comparison. The loop over positions then has no branch that could be
/// mispredicted, and comparisons do not wait for the table.
class Candidates {
 public:
  Candidates(const std::uint8_t* bytes, std::uint32_t size, Workplace& at) : bytes_(bytes), size_(size), at_(at) {
    at.table.fill(rules::empty_bucket(0));
  }

  void begin_segment(std::uint32_t begin, std::uint32_t end) {
    begin_ = begin;
    if (begin != 0 && begin % rules::block_bytes == 0)
      for (rules::Bucket& b : at_.table) b = rules::aged(b, begin);
    const std::uint32_t entered = std::max(begin, rules::entered_before(size_, end));
    rules::Bucket* found = at_.found.data();
#pragma GCC unroll 4
    for (std::uint32_t p = begin; p < entered; ++p) {
      rules::Bucket& entry = at_.table[rules::bucket_of(rules::four_bytes(bytes_ + p))];
      *found++ = entry;
      entry = rules::bucket_with(p);
    }
    for (std::uint32_t p = entered; p < end; ++p) *found++ = rules::empty_bucket(p);
  }

  rules::Match operator()(std::uint32_t position, std::uint32_t end, std::uint32_t length) const {
    const rules::Bucket found = at_.found[position - begin_];
    return rules::match_in(found, bytes_, position, end, length);
  }

 private:
  const std::uint8_t* bytes_;
  std::uint32_t size_, begin_ = 0;  ///< size of the chunk, and first position of the segment
  Workplace& at_;
};

/// A writer that packs bits into bytes and stores eight bytes per call.
/// Range   The buffer extends at least eight bytes beyond the output.
class TokenWriter {
 public:
  explicit TokenWriter(std::uint8_t* to) : begin_(to), to_(to) {}
  void put(rules::Bits b) {
    waiting_ |= b.bits << count_;
    count_ += b.count;
    std::memcpy(to_, &waiting_, 8);
    const std::uint32_t whole = count_ / 8;
    to_ += whole;
    waiting_ >>= 8 * whole;
    count_ %= 8;
  }
  std::uint64_t bits() const { return std::uint64_t(to_ - begin_) * 8 + count_; }
  void finish() { std::memcpy(to_, &waiting_, 8); }

 private:
  std::uint8_t *begin_, *to_;
  std::uint64_t waiting_ = 0;
  std::uint32_t count_ = 0;  ///< number of bits in waiting_, below 8
};

/// Writes the sort keys of all symbols with a count above 0 to `keys`, in ascending order. Returns the number of keys.
/// Ensures first that at least two symbols have a count.
std::uint32_t order(std::uint32_t* counts, std::uint32_t symbols, std::uint32_t* keys) {
  rules::ensure_two(counts, symbols);
  std::uint32_t used = 0;
  for (std::uint32_t s = 0; s < symbols; ++s)
    if (counts[s] != 0) keys[used++] = rules::order_key(counts[s], s);
  std::sort(keys, keys + used);
  return used;
}

void parse_block(const std::uint8_t* bytes, std::uint32_t begin, std::uint32_t end, std::uint32_t min_match_bytes,
                 Candidates& candidates, Workplace& at) {
  std::fill(std::begin(at.counts), std::end(at.counts), 0u);
  at.counts[rules::end_of_block] = 1;
  rules::Token* to = at.tokens.data();
  const auto add = [&](rules::Token token) {
    *to++ = token;
    rules::count_symbols(token, [&](std::uint32_t symbol) { ++at.counts[symbol]; });
  };
  for (; begin < end; begin += rules::segment_bytes) {
    const std::uint32_t segment_end = rules::segment_end(begin, end);
    candidates.begin_segment(begin, segment_end);
    rules::parse_segment(bytes, begin, segment_end, min_match_bytes, candidates, add);
  }
  at.token_count = std::size_t(to - at.tokens.data());
}

/// The first bits of a token, a literal or a match length. Bits 0 to 23 are the code and the extra bits after it. Bits
/// 24 and up are the number of these bits.
using FirstBits = std::uint32_t;

FirstBits bits_of_literal(std::uint32_t byte, const rules::Code* codes) {
  return rules::code_bits(codes[byte]) | rules::code_length(codes[byte]) << 24;
}

FirstBits bits_of_match(std::uint32_t length, const rules::Code* codes) {
  const rules::Bits bits = rules::bits_of_length(length, codes);
  return std::uint32_t(bits.bits) | bits.count << 24;
}

/// The first bits of every token. The index is the literal byte or 256 + length, so that writing needs no branch that
/// could be mispredicted.
class FirstBitsTable {
 public:
  explicit FirstBitsTable(const rules::Code* codes) {
    for (std::uint32_t byte = 0; byte < 256; ++byte) bits_[byte] = bits_of_literal(byte, codes);
    for (std::uint32_t length = rules::min_match; length <= rules::max_match; ++length)
      bits_[256 + length] = bits_of_match(length, codes);
  }
  FirstBits operator()(rules::Token token) const {
    return bits_[rules::is_symbol(token) ? token : 256 + (token >> 16)];
  }

 private:
  std::array<FirstBits, 256 + rules::max_match + 1> bits_;
};

/// The number of tokens from which a table takes less time than it saves.
constexpr std::size_t min_tokens_of_table = 256;

template <class BitsOf>
void write_tokens(const Workplace& at, const BitsOf& bits_of, TokenWriter& writer) {
  for (const rules::Token token : std::span(at.tokens).first(at.token_count)) {
    const bool literal = rules::is_symbol(token);
    const FirstBits first = bits_of(token);
    const rules::Bits second = rules::bits_of_distance(literal ? 1 : token & 0xffff, at.codes.codes);
    const std::uint32_t count = first >> 24;
    const std::uint64_t bits = (first & 0xffffff) | (literal ? 0 : second.bits << count);
    writer.put({bits, count + (literal ? 0 : second.count)});
  }
}

void write_tokens(const Workplace& at, TokenWriter& writer) {
  const rules::Code* codes = at.codes.codes;
  if (at.token_count >= min_tokens_of_table) return write_tokens(at, FirstBitsTable(codes), writer);
  const auto bits_of = [codes](rules::Token token) {
    return rules::is_symbol(token) ? bits_of_literal(token, codes) : bits_of_match(token >> 16, codes);
  };
  write_tokens(at, bits_of, writer);
}

void write_block(Workplace& at, bool last, TokenWriter& writer) {
  at.work.used_literals = order(at.counts, rules::literal_symbols, at.work.keys);
  at.work.used_distances =
      order(at.counts + rules::literal_symbols, rules::distance_symbols, at.work.keys + rules::literal_symbols);
  rules::make_block_codes(at.work, last, at.codes);
  for (std::uint32_t i = 0; 32 * i < at.codes.header_bits; ++i)
    writer.put({at.codes.header[i], std::min(32u, at.codes.header_bits - 32 * i)});
  write_tokens(at, writer);
  writer.put(rules::bits_of(rules::end_of_block, at.codes.codes));
}

}  // namespace

std::vector<std::uint8_t> zlib_frame(std::span<const std::uint8_t> bytes, std::uint32_t min_match_bytes,
                                     std::size_t buffer) {
  // The working memory is kept per thread, because allocating it takes longer than packing a typical chunk.
  thread_local const std::unique_ptr<Workplace> kept = std::make_unique<Workplace>();
  Workplace& at = *kept;
  const auto size = std::uint32_t(bytes.size());
  // Two bytes per input byte suffice: a literal takes at most 15 bits, and a match of four or more bytes at most 48
  // bits.
  at.written.resize(std::max<std::size_t>(at.written.size(),
                                          2 * bytes.size() + rules::blocks_of(size) * 4 * rules::header_words + 64));
  TokenWriter writer(at.written.data());
  Candidates candidates(bytes.data(), size, at);
  const std::uint32_t blocks = rules::blocks_of(size);
  for (std::uint32_t b = 0; b < blocks; ++b) {
    const std::uint32_t begin = b * rules::block_bytes;
    parse_block(bytes.data(), begin, std::min(size, begin + rules::block_bytes), min_match_bytes, candidates, at);
    write_block(at, b + 1 == blocks, writer);
  }
  writer.finish();

  const std::uint32_t packed = rules::deflate_size(size, writer.bits());
  std::vector<std::uint8_t> out;
  out.reserve(rules::zlib_header_bytes + packed + rules::checksum_bytes + buffer);
  for (std::uint32_t i = 0; i < rules::zlib_header_bytes; ++i) out.push_back(rules::zlib_header_byte(i));
  if (rules::stored_as_is(size, writer.bits()))
    for (std::uint32_t i = 0; i < packed; ++i) out.push_back(rules::stored_byte(bytes.data(), size, i));
  else
    out.insert(out.end(), at.written.begin(), at.written.begin() + packed);
  const std::uint32_t adler = libdeflate_adler32(1, bytes.data(), bytes.size());
  for (std::uint32_t i = 0; i < rules::checksum_bytes; ++i) out.push_back(rules::adler_byte(adler, i));
  return out;
}

}  // namespace gigabake
