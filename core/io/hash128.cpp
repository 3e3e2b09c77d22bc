#include "core/io/hash128.h"

#include <charconv>
#include <fmt/format.h>

namespace gigabake {

std::string Hash128::hex() const { return fmt::format("{:016x}{:016x}", hi, lo); }

std::optional<Hash128> Hash128::from_hex(std::string_view text) {
  if (text.size() != 32 || text.find_first_not_of("0123456789abcdef") != std::string_view::npos) return std::nullopt;
  Hash128 h;
  std::from_chars(text.data(), text.data() + 16, h.hi, 16);
  std::from_chars(text.data() + 16, text.data() + 32, h.lo, 16);
  return h;
}

}  // namespace gigabake
