#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <mutex>
#include <optional>
#include <string_view>
#include <utility>

#include "core/base/error.h"
#include "query/query_inputs.h"
#include "query/query_npy.h"

namespace gigabake {
namespace {

constexpr std::size_t block_bytes = std::size_t(1) << 22, max_line_bytes = std::size_t(1) << 16;

/// A column, which holds a coordinate of QueryInput or the id.
struct TableColumn {
  enum class Holds { from, to, id };
  Holds holds = Holds::id;
  std::size_t place = 0;
  std::string name;
};

/// Splits a line into unquoted fields. Returns false if a quote is not closed or is followed by text.
bool split(std::string_view line, std::vector<std::string>& fields) {
  fields.clear();
  for (std::size_t at = 0;; ++at) {
    std::string field;
    if (at < line.size() && line[at] == '"') {
      for (++at;; ++at) {
        if (at >= line.size()) return false;
        if (line[at] == '"' && (++at >= line.size() || line[at] != '"')) break;
        field += line[at];
      }
      if (at < line.size() && line[at] != ',') return false;
    } else {
      const std::size_t comma = std::min(line.find(',', at), line.size());
      field = line.substr(at, comma - at);
      at = comma;
    }
    fields.push_back(std::move(field));
    if (at >= line.size()) return true;
  }
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r')) text.remove_suffix(1);
  return text;
}

/// Column names of a coordinate frame.
struct Names {
  std::array<std::string_view, 3> from;
  std::array<std::string_view, 3> to;
};

Names names_in(QueryFrame frame) {
  if (frame != QueryFrame::lonlat) return {{"x", "y", "z"}, {"to_x", "to_y", "to_z"}};
  return {{"lon", "lat", "height"}, {"to_lon", "to_lat", "to_height"}};
}

class TableQueries final : public QuerySource {
 public:
  /// Takes an open file. `beginning` contains the first bytes of the file, which are already read.
  TableQueries(QueryFile file, std::string beginning, QueryKind kind, QueryFrame frame, const ThreadPool& pool)
      : path_(file.path), pool_(pool), file_(std::move(file.file)), text_(std::move(beginning)) {
    read_head(kind, frame);
  }

  void next(std::size_t maximum, std::vector<QueryInput>& inputs) override {
    const std::vector<std::string_view> lines = read_lines(maximum);
    inputs.resize(lines.size());
    std::mutex mutex;
    std::size_t first_bad = lines.size();
    std::string why;
    pool_.parallel_for(lines.size(), 512, [&](std::size_t begin, std::size_t end, int) {
      std::vector<std::string> scratch;
      for (std::size_t i = begin; i < end; ++i) {
        std::string problem = parse(lines[i], inputs[i], scratch);
        if (problem.empty()) continue;
        const std::scoped_lock lock(mutex);
        if (i < first_bad) {
          first_bad = i;
          why = std::move(problem);
        }
        return;
      }
    });
    if (first_bad < lines.size()) refuse(first_bad, why);
  }

  DirectionForm aim() const override { return aim_; }
  bool have_ids() const override { return has_id_; }
  [[noreturn]] void refuse(std::size_t i, const std::string& why) const override { fail(numbers_[i], why); }

 private:
  [[noreturn]] void fail(std::uint64_t line, const std::string& why) const {
    throw InputError(path_, "line " + std::to_string(line), why);
  }

  /// Reads the next block. Returns false at the end of the file.
  bool fill() {
    text_.erase(0, at_);
    at_ = 0;
    const std::size_t before = text_.size();
    text_.resize(before + block_bytes);
    const std::size_t got = std::fread(text_.data() + before, 1, block_bytes, file_.get());
    text_.resize(before + got);
    if (std::ferror(file_.get()) != 0) throw InputError(path_, "", std::strerror(errno));
    return got > 0;
  }

  /// Returns the next nonempty lines of the buffer. Reads a block if the buffer contains no complete line. The last
  /// line of the file may lack its line end.
  std::vector<std::string_view> read_lines(std::size_t maximum) {
    std::vector<std::string_view> lines;
    numbers_.clear();
    while (lines.empty() && (!at_end_ || at_ < text_.size())) {
      if (!at_end_ && text_.find('\n', at_) == std::string::npos) at_end_ = !fill();
      while (lines.size() < maximum && at_ < text_.size()) {
        const std::size_t end = text_.find('\n', at_);
        if (end == std::string::npos && !at_end_ && text_.size() - at_ <= max_line_bytes) break;
        const std::string_view line = std::string_view(text_).substr(at_, std::min(end, text_.size()) - at_);
        ++line_;
        if (line.size() > max_line_bytes) fail(line_, "longer than 65536 bytes; expected a table of numbers");
        at_ = end == std::string::npos ? text_.size() : end + 1;
        if (trimmed(line).empty()) continue;
        lines.push_back(trimmed(line));
        numbers_.push_back(line_);
      }
    }
    return lines;
  }

  void read_head(QueryKind kind, QueryFrame frame) {
    const std::vector<std::string_view> lines = read_lines(1);
    if (lines.empty()) throw InputError(path_, "", "it is empty; expected a line with the names of its columns");
    std::string_view head = lines[0];
    if (head.starts_with("\xef\xbb\xbf")) head.remove_prefix(3);
    std::vector<std::string> names;
    if (!split(head, names)) fail(numbers_[0], "a quote that is not closed");
    for (const std::string& name : names) columns_.push_back(column_named(std::string(trimmed(name)), kind, frame));
    for (std::size_t i = 0; i < columns_.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (columns_[i].name == columns_[j].name) fail(numbers_[0], "two columns " + in_quotes(columns_[i].name));
    check_columns(kind, frame);
  }

  bool has(std::string_view name) const {
    return std::any_of(columns_.begin(), columns_.end(), [&](const TableColumn& c) { return c.name == name; });
  }

  TableColumn column_named(const std::string& name, QueryKind kind, QueryFrame frame) const {
    const Names known = names_in(frame);
    const std::size_t places = kind == QueryKind::height ? 2 : 3;
    for (std::size_t a = 0; a < places; ++a)
      if (name == known.from[a]) return {TableColumn::Holds::from, a, name};
    if (name == "id") return {TableColumn::Holds::id, 0, name};
    for (std::size_t a = 0; a < 3 && kind != QueryKind::height; ++a)
      if (name == known.to[a]) return {TableColumn::Holds::to, a, name};
    constexpr std::array<std::string_view, 3> direction{"dx", "dy", "dz"};
    constexpr std::array<std::string_view, 2> angles{"azimuth", "elevation"};
    for (std::size_t a = 0; a < 3 && kind == QueryKind::ray && frame == QueryFrame::scene; ++a)
      if (name == direction[a]) return {TableColumn::Holds::to, a, name};
    for (std::size_t a = 0; a < 2 && kind == QueryKind::ray; ++a)
      if (name == angles[a]) return {TableColumn::Holds::to, a, name};
    fail(numbers_[0], "no column is called " + in_quotes(name) + "; expected " + expected(kind, frame));
  }

  static std::string expected(QueryKind kind, QueryFrame frame) {
    const bool is_lonlat = frame == QueryFrame::lonlat;
    const std::string from = is_lonlat ? "lon,lat" : "x,y", third = is_lonlat ? ",height" : ",z";
    const std::string to = is_lonlat ? "to_lon,to_lat,to_height" : "to_x,to_y,to_z";
    if (kind == QueryKind::height) return from;
    if (kind == QueryKind::sight) return from + third + " and " + to;
    return from + third + " and " + (frame == QueryFrame::scene ? "dx,dy,dz or " : "") + "azimuth,elevation or " + to;
  }

  /// Requires all coordinates of the point and exactly one form of the ray's direction.
  void check_columns(QueryKind kind, QueryFrame frame) {
    const Names known = names_in(frame);
    bool good = has(known.from[0]) && has(known.from[1]) && (kind == QueryKind::height || has(known.from[2]));
    has_id_ = has("id");
    std::size_t aims = 0, named = 0;
    const auto offer = [&](DirectionForm aim, std::initializer_list<std::string_view> names) {
      const auto there = std::size_t(std::count_if(names.begin(), names.end(), [&](auto n) { return has(n); }));
      named += there > 0 ? 1 : 0;
      if (there < names.size()) return;
      aim_ = aim;
      ++aims;
    };
    offer(DirectionForm::direction, {"dx", "dy", "dz"});
    offer(DirectionForm::angles, {"azimuth", "elevation"});
    offer(DirectionForm::point, {known.to[0], known.to[1], known.to[2]});
    good = good && (kind == QueryKind::height || (aims == 1 && named == 1));
    if (!good) fail(numbers_[0], "expected the columns " + expected(kind, frame));
  }

  /// Returns the error in the line; empty if there is none.
  std::string parse(std::string_view line, QueryInput& input, std::vector<std::string>& fields) const {
    const bool plain = line.find('"') == std::string_view::npos;
    if (!plain && !split(line, fields)) return "a quote that is not closed, or text after it";
    std::size_t at = 0, count = plain ? std::size_t(std::count(line.begin(), line.end(), ',')) + 1 : fields.size();
    if (count != columns_.size())
      return "expected " + std::to_string(columns_.size()) + " fields, one per column, got " + std::to_string(count);
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      const std::size_t comma = plain ? std::min(line.find(',', at), line.size()) : 0;
      const std::string_view field = trimmed(plain ? line.substr(at, comma - at) : std::string_view(fields[c]));
      at = comma + 1;
      const TableColumn& column = columns_[c];
      if (column.holds == TableColumn::Holds::id) {
        input.id = field;
        continue;
      }
      double& value = (column.holds == TableColumn::Holds::from ? input.from : input.to)[column.place];
      const char* begin = field.data() + (field.starts_with('+') ? 1 : 0);
      const auto [end, error] = std::from_chars(begin, field.data() + field.size(), value);
      if (error != std::errc() || end != field.data() + field.size() || !std::isfinite(value))
        return column.name + ": expected a finite number, got " + in_quotes(field);
    }
    return {};
  }

  std::filesystem::path path_;
  const ThreadPool& pool_;
  std::unique_ptr<std::FILE, QueryFile::Close> file_;
  std::string text_;
  std::size_t at_ = 0;
  bool at_end_ = false;
  std::uint64_t line_ = 0;
  std::vector<std::uint64_t> numbers_;  ///< line numbers of the last read_lines()
  std::vector<TableColumn> columns_;
  DirectionForm aim_ = DirectionForm::point;
  bool has_id_ = false;
};

}  // namespace

std::unique_ptr<QuerySource> table_queries(const std::filesystem::path& file, QueryKind kind, QueryFrame frame,
                                           const ThreadPool& pool) {
  QueryFile opened = open_query_file(file);
  std::string beginning(npy_magic.size(), '\0');
  beginning.resize(std::fread(beginning.data(), 1, beginning.size(), opened.file.get()));
  if (std::ferror(opened.file.get()) != 0) throw InputError(opened.path, "", std::strerror(errno));
  if (beginning == npy_magic) return npy_queries(std::move(opened), kind, frame, pool);
  return std::make_unique<TableQueries>(std::move(opened), std::move(beginning), kind, frame, pool);
}

}  // namespace gigabake
