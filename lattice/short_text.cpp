#include "lattice/short_text.h"

#include <algorithm>

namespace gigabake {

std::string short_text(std::string_view text) {
  constexpr std::size_t most_bytes = 40;
  std::size_t bytes = std::min(text.size(), most_bytes);
  const auto is_inside_a_letter = [&] { return bytes < text.size() && (text[bytes] & 0xc0) == 0x80; };
  while (bytes > 0 && is_inside_a_letter()) --bytes;
  std::string out(text.substr(0, bytes));
  for (char& c : out)
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  return text.size() > bytes ? out + "…" : out;
}

}  // namespace gigabake
