#include "format/scene/check/scene_checksum.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace gigabake {
namespace {

constexpr std::string_view checksum_begin = " Checksum=\"", checksum_zeros = "00000000000000000000000000000000";
constexpr std::size_t no_digits = std::string::npos;

/// Returns the position of the checksum's 32 digits in the text; no_digits if there is no checksum.
std::size_t find_checksum(std::string_view text) {
  const std::size_t at = text.find(checksum_begin);
  const std::size_t digits = at + checksum_begin.size(), end = digits + checksum_zeros.size();
  return at == std::string_view::npos || end >= text.size() || text[end] != '"' ? no_digits : digits;
}

/// Returns the hash of the text with the 32 digits of its checksum, which begin at `at`, replaced by zeros.
Hash128 hash_without(std::string_view text, std::size_t at) {
  XXH3_state_t state;
  XXH3_128bits_reset(&state);
  for (const std::string_view part : {text.substr(0, at), checksum_zeros, text.substr(at + checksum_zeros.size())})
    XXH3_128bits_update(&state, part.data(), part.size());
  const XXH128_hash_t h = XXH3_128bits_digest(&state);
  return {h.low64, h.high64};
}

}  // namespace

TextChecksum checksum_of(std::string_view text) {
  const std::size_t at = find_checksum(text);
  if (at == no_digits) return {};
  const Hash128 value = hash_without(text, at);
  return {value, text.substr(at, checksum_zeros.size()) == value.hex()};
}

SummedText summed(std::string text) {
  const std::size_t at = find_checksum(text);
  if (at == no_digits) return {std::move(text), {}};
  const Hash128 checksum = hash_without(text, at);
  text.replace(at, checksum_zeros.size(), checksum.hex());
  return {std::move(text), checksum};
}

}  // namespace gigabake
