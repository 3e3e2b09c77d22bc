#include "format/source/content/data_uri.h"

#include <algorithm>
#include <cctype>

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "format/source/source_file.h"

namespace gigabake {
namespace {

std::string lower_case(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return out;
}

/// Returns the 6 bits that a base64 character encodes; -1 for any other character.
int base64_bits(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+' || c == '-') return 62;
  return c == '/' || c == '_' ? 63 : -1;
}

std::vector<std::uint8_t> base64_bytes(const std::filesystem::path& file, const std::string& key, std::string_view uri,
                                       std::string_view text) {
  std::vector<std::uint8_t> out;
  out.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    if (c == ' ' || c == '\t' || c == '\r' || c == '\n') continue;
    const int more = base64_bits(c);
    if (more < 0) throw InputError(file, key, "expected base64 in " + in_quotes(uri) + ", got " + in_quotes({&c, 1}));
    bits = bits << 6 | std::uint32_t(more);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    out.push_back(std::uint8_t(bits >> count));
  }
  return out;
}

}  // namespace

bool is_data_uri(std::string_view uri) { return lower_case(uri.substr(0, 5)) == "data:"; }

std::vector<std::uint8_t> data_uri_bytes(const std::filesystem::path& file, const std::string& key,
                                         std::string_view uri) {
  const auto comma = uri.find(',');
  if (comma == uri.npos) throw InputError(file, key, "expected a comma in the data URI " + in_quotes(uri));
  MemoryClaim(file).add_items(uri.size(), 2, key, "bytes of a data URI");
  const std::string head = lower_case(uri.substr(0, comma));
  std::string_view data = uri.substr(comma + 1);
  std::string decoded;  // stays empty without percent escapes, which are rare in base64
  if (data.find('%') != data.npos) data = decoded = percent_decoded(data);
  const std::string parameter = head.substr(head.rfind(';') + 1);  // the whole head if there is no parameter
  if (parameter.find("base64") != parameter.npos) return base64_bytes(file, key, uri, data);
  return {data.begin(), data.end()};
}

std::vector<std::uint8_t> uri_bytes(const SourceFiles& files, const std::filesystem::path& base, const std::string& key,
                                    const std::string& uri) {
  if (is_data_uri(uri)) return data_uri_bytes(base, key, uri);
  const std::filesystem::path path = resolve_uri(files.root(), base, key, uri);
  if (!files.has(path)) throw InputError(base, key, "no such file: " + path.string());
  return files.read_referenced(path);
}

}  // namespace gigabake
