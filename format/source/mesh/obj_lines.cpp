#include "format/source/mesh/obj_lines.h"

#include <algorithm>
#include <charconv>
#include <string>

#include "lattice/error.h"

namespace gigabake {
namespace {

constexpr std::string_view blank = " \t\r\f\v";
constexpr std::size_t longest_line = std::size_t(1) << 26;

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(blank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blank) - first + 1);
}

/// Takes text block by block.
class Lines {
 public:
  Lines(const std::filesystem::path& file, const std::function<void(const ObjLine&)>& visit)
      : file_(file), visit_(visit) {}

  void take_block(std::span<const std::uint8_t> block) {
    const std::string_view all(reinterpret_cast<const char*>(block.data()), block.size());
    if (const std::size_t zero = all.find('\0'); zero != std::string_view::npos)
      throw InputError(file_, "", "expected text in ASCII or UTF-8", bytes_ + zero);
    bytes_ += all.size();
    std::size_t at = 0;
    for (std::size_t end; (end = all.find('\n', at)) != std::string_view::npos; at = end + 1)
      take_line_end(all.substr(at, end - at));
    add_to(cut_, all.substr(at));
  }

  void finish() {
    if (!cut_.empty()) take_line_end("");
    if (!joined_.empty()) visit_joined({});
  }

 private:
  /// What a block cuts is kept until the next one.
  void take_line_end(std::string_view end) {
    if (cut_.empty()) return take_line(end);
    add_to(cut_, end);
    take_line(cut_);
    cut_.clear();
  }

  void take_line(std::string_view text) {
    std::string_view line = trimmed(text);
    ++number_;
    if (!line.empty() && line.back() == '\\') {
      add_to(joined_, line.substr(0, line.size() - 1));
      joined_ += ' ';
    } else if (!joined_.empty()) {
      visit_joined(line);
    } else {
      visit(line);
    }
  }

  void visit_joined(std::string_view end) {
    add_to(joined_, end);
    visit(trimmed(joined_));
    joined_.clear();
  }

  void visit(std::string_view line) const {
    if (line.empty() || line[0] == '#') return;
    const std::string_view word = take_word(line);
    visit_({number_, word, line});
  }

  void add_to(std::string& line, std::string_view text) const {
    if (text.size() > longest_line - line.size())
      throw InputError(file_, "line " + std::to_string(number_ + 1), "is longer than 64 MiB");
    line += text;
  }

  const std::filesystem::path& file_;
  const std::function<void(const ObjLine&)>& visit_;
  std::string cut_, joined_;
  std::size_t number_ = 0;
  std::uint64_t bytes_ = 0;
};

}  // namespace

std::string_view take_word(std::string_view& rest) {
  const std::string_view word = rest.substr(0, rest.find_first_of(blank));
  rest = trimmed(rest.substr(word.size()));
  return word;
}

void for_each_obj_line(const std::filesystem::path& file, std::span<const std::uint8_t> text,
                       const std::function<void(const ObjLine&)>& visit) {
  Lines lines(file, visit);
  lines.take_block(text);
  lines.finish();
}

void for_each_obj_line(const std::filesystem::path& file, const SourceBytes& text,
                       const std::function<void(const ObjLine&)>& visit) {
  Lines lines(file, visit);
  text.for_each_block(read_block_bytes, [&](std::span<const std::uint8_t> block) { lines.take_block(block); });
  lines.finish();
}

std::span<const std::uint8_t> whole_lines(std::span<const std::uint8_t> head) {
  std::size_t bytes = head.size();
  while (bytes > 0 && head[bytes - 1] != '\n') --bytes;
  return head.first(bytes);
}

std::vector<double> obj_numbers(std::string_view text, std::size_t most) {
  std::vector<double> out;
  while (out.size() < most && !text.empty()) {
    std::string_view word = take_word(text);
    if (word.starts_with('+')) word.remove_prefix(1);
    double v = 0;
    const auto end = std::from_chars(word.data(), word.data() + word.size(), v);
    if (end.ec != std::errc() || end.ptr != word.data() + word.size()) break;
    out.push_back(v);
  }
  return out;
}

}  // namespace gigabake
