#include "format/source/mesh/ply_header.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>
#include <string_view>

#include "core/base/error.h"
#include "format/source/source_file.h"

namespace gigabake {
namespace {

constexpr std::size_t max_properties = 1024, max_line_bytes = 4096;
constexpr std::string_view blank = " \t\r";

std::string_view take_word(std::string_view& rest) {
  rest.remove_prefix(std::min(rest.find_first_not_of(blank), rest.size()));
  const std::string_view word = rest.substr(0, rest.find_first_of(blank));
  rest.remove_prefix(word.size());
  return word;
}

std::string trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(blank);
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(blank) - first + 1));
}

std::string in_lower_case(std::string_view word) {
  std::string out(word);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return out;
}

class HeaderReader {
 public:
  HeaderReader(const std::filesystem::path& file, std::span<const std::uint8_t> bytes)
      : file_(file), text_(reinterpret_cast<const char*>(bytes.data()), bytes.size()) {
    if (text_.starts_with("\xEF\xBB\xBF")) at_ = 3;
    // Only the first line determines the type of line ends, because binary values may begin with either byte.
    const std::size_t end = text_.find_first_of("\r\n");
    if (end != std::string_view::npos && text_[end] == '\r' && !text_.substr(end).starts_with("\r\n")) line_end_ = '\r';
  }

  PlyHeader read() {
    if (trimmed(next_line()) != "ply") fail("expected a PLY, which begins with \"ply\"");
    bool has_format = false;
    while (true) {
      std::string_view rest = next_line();
      const std::string_view word = take_word(rest);
      if (word == "end_header") break;
      if (word == "format")
        has_format = true, take_format(rest);
      else if (word == "comment")
        take_comment(rest);
      else if (word == "element")
        take_element(rest);
      else if (word == "property")
        take_property(rest);
      else if (!word.empty() && word != "obj_info")
        fail("expected a line of a PLY header, got " + in_quotes(word));
    }
    if (!has_format) fail("the header has no format");
    out_.bytes = at_;
    out_.lines = line_;
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(file_, "line " + std::to_string(line_), message);
  }

  std::string_view next_line() {
    ++line_;
    const std::size_t end = text_.find(line_end_, at_);
    if (end == std::string_view::npos || end - at_ > max_line_bytes) fail("the header has no \"end_header\"");
    const std::string_view line = text_.substr(at_, end - at_);
    at_ = end + 1;
    return line;
  }

  void take_format(std::string_view rest) {
    static const std::map<std::string_view, PlyFormat> formats{{"ascii", PlyFormat::ascii},
                                                               {"binary_little_endian", PlyFormat::little_endian},
                                                               {"binary_big_endian", PlyFormat::big_endian}};
    const auto format = formats.find(take_word(rest));
    if (format == formats.end()) fail("expected the format ascii, binary_little_endian or binary_big_endian");
    if (take_word(rest) != "1.0") fail("expected PLY 1.0");
    out_.format = format->second;
  }

  void take_comment(std::string_view rest) {
    if (in_lower_case(take_word(rest)) == "texturefile") out_.textures.push_back(trimmed(rest));
  }

  void take_element(std::string_view rest) {
    PlyElement element;
    element.name = in_lower_case(take_word(rest));
    const std::string_view count = take_word(rest);
    const auto parsed = std::from_chars(count.data(), count.data() + count.size(), element.count);
    if (count.empty() || parsed.ec != std::errc() || parsed.ptr != count.data() + count.size())
      fail("expected the number of elements, got " + in_quotes(count));
    out_.elements.push_back(std::move(element));
  }

  PlyType type(std::string_view name) const {
    static const std::map<std::string_view, PlyType> types{
        {"char", PlyType::int8},      {"int8", PlyType::int8},       {"uchar", PlyType::uint8},
        {"uint8", PlyType::uint8},    {"short", PlyType::int16},     {"int16", PlyType::int16},
        {"ushort", PlyType::uint16},  {"uint16", PlyType::uint16},   {"int", PlyType::int32},
        {"int32", PlyType::int32},    {"uint", PlyType::uint32},     {"uint32", PlyType::uint32},
        {"float", PlyType::float32},  {"float32", PlyType::float32}, {"double", PlyType::float64},
        {"float64", PlyType::float64}};
    const auto at = types.find(name);
    if (at == types.end()) fail("expected a PLY type such as uchar, int or float32, got " + in_quotes(name));
    return at->second;
  }

  void take_property(std::string_view rest) {
    if (out_.elements.empty()) fail("a property before any element");
    std::vector<PlyProperty>& properties = out_.elements.back().properties;
    if (properties.size() == max_properties) fail("more than 1024 properties of one element");
    PlyProperty property;
    std::string_view word = take_word(rest);
    if (word == "list") {
      property.count = type(take_word(rest));
      if (!is_integer(*property.count)) fail("expected an integer type for the length of a list");
      word = take_word(rest);
    }
    property.type = type(word);
    property.name = in_lower_case(take_word(rest));
    if (property.name.empty()) fail("the property has no name");
    properties.push_back(std::move(property));
  }

  const std::filesystem::path& file_;
  std::string_view text_;
  char line_end_ = '\n';
  std::size_t at_ = 0, line_ = 0;
  PlyHeader out_;
};

}  // namespace

std::size_t byte_count(PlyType type) {
  switch (type) {
    case PlyType::int8:
    case PlyType::uint8:
      return 1;
    case PlyType::int16:
    case PlyType::uint16:
      return 2;
    case PlyType::float64:
      return 8;
    default:
      return 4;
  }
}

bool is_integer(PlyType type) { return type != PlyType::float32 && type != PlyType::float64; }

std::optional<std::size_t> PlyElement::find(std::initializer_list<const char*> names) const {
  for (std::size_t i = 0; i < properties.size(); ++i)
    for (const char* one : names)
      if (properties[i].name == one) return i;
  return std::nullopt;
}

PlyHeader read_ply_header(const std::filesystem::path& file, std::span<const std::uint8_t> bytes) {
  return HeaderReader(file, bytes).read();
}

}  // namespace gigabake
