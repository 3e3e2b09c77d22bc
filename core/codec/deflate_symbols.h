/// Deflate's alphabets and the encoding of tokens. A token is a literal or a match.
///
/// Exact   Integers: host and device give the same bits.
/// Source  RFC 1951, 3.2.5.
#pragma once

#include <bit>
#include <cstdint>

#include "core/base/host_device.h"

namespace gigabake::deflate {

inline constexpr std::uint32_t literal_symbols = 286, distance_symbols = 30, end_of_block = 256;
/// The number of symbols of both alphabets. Arrays of a block's counts or codes contain the literal/length alphabet
/// first, then the distance alphabet.
inline constexpr std::uint32_t block_symbols = literal_symbols + distance_symbols;
inline constexpr std::uint32_t max_match = 258;

/// Returns ⌊log2 value⌋.
/// Range   value > 0.
GB_HD std::uint32_t floor_log2(std::uint32_t value) {
#if defined(__CUDA_ARCH__)
  return 31u - unsigned(__clz(int(value)));
#else
  return 31u - unsigned(std::countl_zero(value));
#endif
}

/// The symbol of a length or distance, and its extra bits.
struct SymbolAndBits {
  std::uint32_t symbol, bits, bit_count;
};

/// Returns the symbol of a match length.
/// Range   3 ≤ length ≤ 258.
GB_HD SymbolAndBits symbol_of_length(std::uint32_t length) {
  const std::uint32_t above = length - 3, bits = floor_log2(above | 4) - 2;
  const SymbolAndBits found{257 + 4 * bits + (above >> bits), above & ((1u << bits) - 1), bits};
  return length == max_match ? SymbolAndBits{285, 0, 0} : found;
}

/// Returns the symbol of a distance as an index below `block_symbols`.
/// Range   1 ≤ distance ≤ 32768.
GB_HD SymbolAndBits symbol_of_distance(std::uint32_t distance) {
  const std::uint32_t above = distance - 1, bits = floor_log2(above | 2) - 1;
  return {literal_symbols + 2 * bits + (above >> bits), above & ((1u << bits) - 1), bits};
}

/// A literal, the end of a block, or a match. A literal is stored as its byte, the end of a block as 256, and a match
/// as length << 16 | distance.
using Token = std::uint32_t;
GB_HD bool is_symbol(Token token) { return token <= end_of_block; }
GB_HD Token match_token(std::uint32_t length, std::uint32_t distance) { return length << 16 | distance; }

/// Calls `add(symbol)` for each symbol of the token.
template <class Add>
GB_HD void count_symbols(Token token, const Add& add) {
  if (is_symbol(token)) return add(token);
  add(symbol_of_length(token >> 16).symbol);
  add(symbol_of_distance(token & 0xffff).symbol);
}

/// A code in bits 0 to 15, and its length from bit 16 on. The first bit of the code is bit 0. The value 0 means that
/// the symbol has no code.
using Code = std::uint32_t;
inline constexpr std::uint32_t max_code_bits = 15;
GB_HD std::uint32_t code_bits(Code code) { return code & 0xffff; }
GB_HD std::uint32_t code_length(Code code) { return code >> 16; }

/// A string of up to 48 bits; its first bit is bit 0.
struct Bits {
  std::uint64_t bits;
  std::uint32_t count;
};

GB_HD Bits bits_of_symbol(const SymbolAndBits& s, const Code* codes) {
  const Code code = codes[s.symbol];
  return {code_bits(code) | std::uint64_t(s.bits) << code_length(code), code_length(code) + s.bit_count};
}
GB_HD Bits bits_of_length(std::uint32_t length, const Code* codes) {
  return bits_of_symbol(symbol_of_length(length), codes);
}
GB_HD Bits bits_of_distance(std::uint32_t distance, const Code* codes) {
  return bits_of_symbol(symbol_of_distance(distance), codes);
}

/// Returns the encoded token.
/// Range   `codes` has block_symbols entries, and codes for the token's symbols.
GB_HD Bits bits_of(Token token, const Code* codes) {
  if (is_symbol(token)) return {code_bits(codes[token]), code_length(codes[token])};
  const Bits length = bits_of_length(token >> 16, codes), distance = bits_of_distance(token & 0xffff, codes);
  return {length.bits | distance.bits << length.count, length.count + distance.count};
}

}  // namespace gigabake::deflate
