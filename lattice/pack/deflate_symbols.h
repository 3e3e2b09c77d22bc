/// Deflate's alphabets and how a token, which is a literal or a match, is written with them.
///
/// Exact   Integers: host and device give the same bits.
/// Source  RFC 1951, 3.2.5.
#pragma once

#include <bit>
#include <cstdint>

#include "lattice/host_device.h"

namespace gigabake::deflate {

inline constexpr std::uint32_t literal_symbols = 286, distance_symbols = 30, end_of_block = 256;
/// Literals and lengths first, then distances: counts and codes of a block stand in one array.
inline constexpr std::uint32_t block_symbols = literal_symbols + distance_symbols;
inline constexpr std::uint32_t longest_match = 258;

/// How many bits a number takes, less one. Range  value > 0.
GB_HD std::uint32_t floor_log2(std::uint32_t value) {
#if defined(__CUDA_ARCH__)
  return 31u - unsigned(__clz(int(value)));
#else
  return 31u - unsigned(std::countl_zero(value));
#endif
}

/// A symbol of a length or distance, and the bits that follow it.
struct SymbolAndBits {
  std::uint32_t symbol, bits, bit_count;
};

/// Range  3 ≤ length ≤ 258.
GB_HD SymbolAndBits symbol_of_length(std::uint32_t length) {
  const std::uint32_t above = length - 3, bits = floor_log2(above | 4) - 2;
  const SymbolAndBits found{257 + 4 * bits + (above >> bits), above & ((1u << bits) - 1), bits};
  return length == longest_match ? SymbolAndBits{285, 0, 0} : found;
}

/// A number among `block_symbols`. Range  1 ≤ distance ≤ 32768.
GB_HD SymbolAndBits symbol_of_distance(std::uint32_t distance) {
  const std::uint32_t above = distance - 1, bits = floor_log2(above | 2) - 1;
  return {literal_symbols + 2 * bits + (above >> bits), above & ((1u << bits) - 1), bits};
}

/// A literal is its byte, the end of a block is 256, a match is its length << 16 | distance.
using Token = std::uint32_t;
GB_HD bool is_symbol(Token token) { return token <= end_of_block; }
GB_HD Token match_token(std::uint32_t length, std::uint32_t distance) { return length << 16 | distance; }

/// Counts the token's symbols by `add(symbol)`.
template <class Add>
GB_HD void count_symbols(Token token, const Add& add) {
  if (is_symbol(token)) return add(token);
  add(symbol_of_length(token >> 16).symbol);
  add(symbol_of_distance(token & 0xffff).symbol);
}

/// A symbol's code, first bit lowest, and its length << 16; 0: has none.
using Code = std::uint32_t;
inline constexpr std::uint32_t longest_code = 15;
GB_HD std::uint32_t code_bits(Code code) { return code & 0xffff; }
GB_HD std::uint32_t code_length(Code code) { return code >> 16; }

/// Up to 48 bits, first bit lowest.
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

/// What the token is written as. Range  `codes` has block_symbols, and codes for the token's.
GB_HD Bits bits_of(Token token, const Code* codes) {
  if (is_symbol(token)) return {code_bits(codes[token]), code_length(codes[token])};
  const Bits length = bits_of_length(token >> 16, codes), distance = bits_of_distance(token & 0xffff, codes);
  return {length.bits | distance.bits << length.count, length.count + distance.count};
}

}  // namespace gigabake::deflate
