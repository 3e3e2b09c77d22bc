#include "format/source/json/json_parse.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "format/source/json/json_repair.h"

namespace gigabake {
namespace {

constexpr int deepest_json = 128;
constexpr std::size_t max_json_bytes = std::size_t(1) << 28;
/// Bytes of values in nlohmann::json, including the overhead of the allocator. An array is a growing vector, an object
/// is a map.
constexpr std::uint64_t item_bytes = 32, member_bytes = 112, container_bytes = 80, text_bytes = 64;

/// Throws InputError if the text is nested too deeply, because code that processes the values recurses.
void check_nesting(const std::filesystem::path& file, std::span<const std::uint8_t> text) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = char(text[i]);
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
      continue;
    }
    if (c == '"') in_string = true;
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (depth > deepest_json) throw InputError(file, "", "JSON nested deeper than 128 levels", i);
  }
}

class Builder : public nlohmann::json_sax<Json> {
 public:
  Builder(const std::filesystem::path& file, std::span<const std::uint8_t> text, const JsonFold& fold)
      : file_(file), text_(text), fold_(fold), memory_(file) {}

  Json take() { return std::move(document_); }

  bool null() override { return add(nullptr, 0); }
  bool boolean(bool v) override { return add(v, 0); }
  bool number_integer(number_integer_t v) override { return add(v, 0); }
  bool number_unsigned(number_unsigned_t v) override { return add(v, 0); }
  bool number_float(number_float_t v, const string_t&) override { return add(v, 0); }
  bool string(string_t& v) override {
    const std::uint64_t bytes = text_bytes + v.size();
    return add(std::move(v), bytes);
  }
  bool binary(binary_t&) override { return false; }  // JSON has no binary values
  bool start_object(std::size_t) override { return open(Json::object()); }
  bool start_array(std::size_t) override { return open(Json::array()); }
  bool key(string_t& name) override {
    open_.back().key = std::move(name);
    return true;
  }
  bool end_array() override {
    OpenJson done = close();
    return add(std::move(done.value), done.bytes);
  }
  bool end_object() override {
    OpenJson done = close();
    if (!fold_ || !fold_(open_, done.value)) return add(std::move(done.value), done.bytes);
    memory_.give_back(done.bytes);
    if (!open_.empty()) ++open_.back().items;
    return true;
  }
  bool parse_error(std::size_t byte, const std::string&, const Json::exception& e) override {
    constexpr int out_of_range = 406;
    if (e.id == out_of_range) throw InputError(file_, "", "not valid JSON: a number that is too large", byte);
    const std::size_t end = std::min(byte, text_.size());
    const auto line = 1 + std::count(text_.begin(), text_.begin() + std::ptrdiff_t(end), std::uint8_t('\n'));
    throw InputError(file_, "", "not valid JSON in line " + std::to_string(line) + reason_of(byte, e.what()), byte);
  }

 private:
  /// Returns the reason of a syntax error. `byte` is the offset behind the first character that cannot be read.
  std::string reason_of(std::size_t byte, const std::string& message) const {
    const std::string_view text(reinterpret_cast<const char*>(text_.data()), text_.size());
    for (const std::string_view name : {"NaN", "nan", "Infinity", "inf"})
      for (const std::size_t before : {1u, 2u})
        if (byte >= before && text.substr(std::min(byte - before, text.size())).starts_with(name))
          return ": " + std::string(name) + " is not a JSON number";
    return expected_in(message);
  }

  /// Returns the expected token from the end of the library's message.
  static std::string expected_in(const std::string& message) {
    const auto at = message.rfind("; expected ");
    if (at != message.npos) return ": " + message.substr(at + 2);
    return message.find("end of input") != message.npos ? ": it ends too early" : "";
  }

  bool open(Json value) {
    claim(container_bytes);
    open_.push_back({std::move(value), {}, 0, container_bytes});
    return true;
  }

  OpenJson close() {
    OpenJson done = std::move(open_.back());
    open_.pop_back();
    return done;
  }

  void claim(std::uint64_t bytes) { memory_.add(bytes, "", "the values of its JSON"); }

  /// Adds a value to the innermost incomplete container, or makes it the document. `own_bytes` is the memory of the
  /// value without its entry in the container. This memory is already claimed if the value is an object or an array.
  bool add(Json value, std::uint64_t own_bytes) {
    const bool is_claimed = value.is_structured();
    if (open_.empty()) {
      document_ = std::move(value);
      return true;
    }
    OpenJson& around = open_.back();
    const std::uint64_t place = around.value.is_array() ? item_bytes : member_bytes + around.key.size();
    claim(place + (is_claimed ? 0 : own_bytes));
    around.bytes += place + own_bytes;
    ++around.items;
    if (around.value.is_array())
      around.value.push_back(std::move(value));
    else
      around.value[around.key] = std::move(value);
    return true;
  }

  const std::filesystem::path& file_;
  std::span<const std::uint8_t> text_;
  const JsonFold& fold_;
  MemoryClaim memory_;
  std::vector<OpenJson> open_;
  Json document_;
};

}  // namespace

Json parse_json(const std::filesystem::path& file, std::span<const std::uint8_t> text, const JsonFold& fold) {
  if (text.size() > max_json_bytes)
    throw InputError(file, "", "has more than 2^28 bytes of JSON; split it, or store buffers in separate files");
  check_nesting(file, text);
  if (text.size() >= 3 && text[0] == 0xef && text[1] == 0xbb && text[2] == 0xbf)
    throw InputError(file, "", "JSON starts with a byte order mark; save it without");
  const std::optional<std::string> repaired = repaired_json(text);
  if (repaired) text = {reinterpret_cast<const std::uint8_t*>(repaired->data()), repaired->size()};
  Builder builder(file, text, fold);
  Json::sax_parse(text.begin(), text.end(), &builder);
  return builder.take();
}

}  // namespace gigabake
