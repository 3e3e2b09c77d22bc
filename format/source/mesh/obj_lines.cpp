#include "format/source/mesh/obj_lines.h"

#include <algorithm>
#include <charconv>
#include <string>

#include "core/base/error.h"

namespace gigabake {
namespace {

constexpr std::string_view blank = " \t\r\f\v";
constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
constexpr std::size_t max_line_bytes = std::size_t(1) << 26;

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(blank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blank) - first + 1);
}

/// A search for line ends: carriage returns and line feeds. Old programs end lines with a carriage return only.
class LineEnds {
 public:
  explicit LineEnds(std::string_view text) : text_(text) {}

  /// Returns the position of the first line end at or after `at`, or npos. `at` must not decrease between calls.
  std::size_t next(std::size_t at) {
    if (feed_ < at || at == 0) feed_ = std::min(text_.find('\n', at), text_.size());
    if (return_ < at || at == 0) return_ = std::min(text_.find('\r', at), text_.size());
    const std::size_t end = std::min(feed_, return_);
    return end == text_.size() ? std::string_view::npos : end;
  }

 private:
  std::string_view text_;
  std::size_t feed_ = 0, return_ = 0;
};

/// A splitter of text into lines. It receives the text in blocks.
class Lines {
 public:
  Lines(const std::filesystem::path& file, const std::function<void(const ObjLine&)>& visit)
      : file_(file), visit_(visit) {}

  void take_block(std::span<const std::uint8_t> block) {
    const std::string_view all(reinterpret_cast<const char*>(block.data()), block.size());
    if (const std::size_t zero = all.find('\0'); zero != std::string_view::npos)
      throw InputError(file_, "", "expected text in ASCII or UTF-8", bytes_ + zero);
    std::size_t at = bytes_ == 0 && all.starts_with(byte_order_mark) ? byte_order_mark.size() : 0;
    bytes_ += all.size();
    if (!all.empty() && cut_.ends_with('\r')) take_line_end(all.substr(0, 0)), at = all[0] == '\n' ? 1 : 0;
    LineEnds ends(all);
    for (std::size_t end; (end = ends.next(at)) != std::string_view::npos;) {
      if (all[end] == '\r' && end + 1 == all.size()) break;  // the next block may begin with the line feed
      take_line_end(all.substr(at, end - at));
      at = end + (all.substr(end).starts_with("\r\n") ? 2 : 1);
    }
    add_to(cut_, all.substr(at));
  }

  void finish() {
    if (!cut_.empty()) take_line_end("");
    if (!joined_.empty()) visit_joined({});
  }

 private:
  /// Completes a line, of which `end` is the last part. cut_ has the part that previous blocks contain.
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
    if (text.size() > max_line_bytes - line.size())
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
  while (bytes > 0 && head[bytes - 1] != '\n' && head[bytes - 1] != '\r') --bytes;
  return head.first(bytes);
}

std::string_view without_comment(std::string_view text) {
  for (std::size_t at = text.find('#'); at != std::string_view::npos; at = text.find('#', at + 1))
    if (at == 0 || blank.find(text[at - 1]) != std::string_view::npos) return trimmed(text.substr(0, at));
  return text;
}

std::string plain_name(std::string_view name) {
  if (name.size() > 2 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
  std::string out(name);
  std::replace(out.begin(), out.end(), '\\', '/');
  return out;
}

std::vector<double> obj_numbers(std::string_view text, std::size_t max_count) {
  std::vector<double> out;
  while (out.size() < max_count && !text.empty()) {
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
