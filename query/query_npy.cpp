#include "query/query_npy.h"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/math/octahedral.h"

namespace gigabake {
namespace {

static_assert(std::endian::native == std::endian::little, "records have the byte order of memory");

constexpr std::size_t max_header_bytes = std::size_t(1) << 16, rows_per_range = 1024;

/// The shape of an array of doubles.
struct NpyShape {
  std::uint64_t rows = 0, columns = 0;
};

/// Returns the text after `'key':` in the header, without leading spaces; empty if there is none.
std::string_view value_of(std::string_view header, std::string_view key) {
  const std::size_t at = header.find(std::string("'") + std::string(key) + "':");
  if (at == std::string_view::npos) return {};
  const std::size_t value = header.find_first_not_of(' ', at + key.size() + 3);
  return value == std::string_view::npos ? std::string_view{} : header.substr(value);
}

/// Reads "(rows, columns)". Returns false for any other text.
bool read_shape(std::string_view text, NpyShape& shape) {
  std::uint64_t* const numbers[2] = {&shape.rows, &shape.columns};
  for (int i = 0; i < 2; ++i) {
    if (!text.starts_with(i == 0 ? '(' : ',')) return false;
    text.remove_prefix(std::min(text.find_first_not_of(' ', 1), text.size()));
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), *numbers[i]);
    if (error != std::errc()) return false;
    text.remove_prefix(std::size_t(end - text.data()));
    text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  }
  return text.starts_with(')') || text.starts_with(",)");
}

/// The numbers of columns that a file may have, and their meaning for messages.
struct NpyColumns {
  std::uint64_t count, count_with_direction;  ///< count_with_direction is 0 if there is no form with a direction
  std::string expected;
};

NpyColumns columns_of(QueryKind kind, QueryFrame frame) {
  const bool is_scene = frame == QueryFrame::scene;
  const bool is_lonlat = frame == QueryFrame::lonlat;
  const std::string point = is_lonlat ? "lon, lat" : "x, y", third = is_lonlat ? ", height" : ", z";
  if (kind == QueryKind::height) return {2, 0, "2 columns (" + point + ")"};
  if (kind == QueryKind::sight) return {6, 0, "6 columns (" + point + third + " of both points)"};
  const std::string angles = "5 columns (" + point + third + ", azimuth, elevation)";
  return {5, is_scene ? std::uint64_t(6) : 0, is_scene ? angles + " or 6 (x, y, z, dx, dy, dz)" : angles};
}

class NpyQueries final : public QuerySource {
 public:
  NpyQueries(QueryFile file, QueryKind kind, QueryFrame frame, const ThreadPool& pool)
      : path_(std::move(file.path)), file_(std::move(file.file)), pool_(pool), kind_(kind) {
    read_header(columns_of(kind, frame));
  }

  void next(std::size_t maximum, std::vector<QueryInput>& inputs) override {
    first_ = row_;
    const auto rows = std::size_t(std::min<std::uint64_t>(maximum, shape_.rows - row_));
    const auto columns = std::size_t(shape_.columns);
    numbers_.resize(rows * columns);
    read(numbers_.data(), numbers_.size() * sizeof(double));
    row_ += rows;
    if (row_ == shape_.rows && std::fgetc(file_.get()) != EOF) fail(at_, "bytes after the last row");
    inputs.resize(rows);
    std::mutex mutex;
    std::size_t bad = numbers_.size();
    pool_.parallel_for(rows, rows_per_range, [&](std::size_t begin, std::size_t end, int) {
      for (std::size_t i = begin * columns; i < end * columns; ++i) {
        if (!std::isfinite(numbers_[i])) {
          const std::scoped_lock lock(mutex);
          bad = std::min(bad, i);
          return;
        }
        set(inputs[i / columns], i % columns, numbers_[i]);
      }
    });
    if (bad < numbers_.size()) fail(byte_of(first_) + bad * sizeof(double), "expected a finite number");
  }

  DirectionForm aim() const override {
    if (kind_ != QueryKind::ray) return DirectionForm::point;
    return shape_.columns == 6 ? DirectionForm::direction : DirectionForm::angles;
  }
  std::optional<std::uint64_t> count() const override { return shape_.rows; }
  [[noreturn]] void refuse(std::size_t i, const std::string& why) const override { fail(byte_of(first_ + i), why); }

 private:
  [[noreturn]] void fail(std::uint64_t byte, const std::string& why) const {
    throw InputError(path_, "byte " + std::to_string(byte), why);
  }
  std::uint64_t byte_of(std::uint64_t row) const { return data_ + row * shape_.columns * sizeof(double); }

  void set(QueryInput& input, std::size_t column, double value) const {
    const std::size_t in_from = kind_ == QueryKind::height ? 2 : 3;
    (column < in_from ? input.from[column] : input.to[column - in_from]) = value;
  }

  void read(void* bytes, std::size_t size) {
    const std::size_t got = std::fread(bytes, 1, size, file_.get());
    at_ += got;
    if (std::ferror(file_.get()) != 0) throw InputError(path_, "", std::strerror(errno));
    if (got < size) fail(at_, "the file ends here; expected " + std::to_string(size - got) + " more bytes");
  }

  /// Reads the version and the length of the header's text. Returns the length.
  std::size_t header_size() {
    std::uint8_t version[2];
    read(version, sizeof version);
    if (version[0] < 1 || version[0] > 3) fail(npy_magic.size(), "expected a .npy file of version 1, 2 or 3");
    std::uint8_t size[4] = {};
    read(size, version[0] == 1 ? 2 : 4);
    return std::size_t(size[0]) | std::size_t(size[1]) << 8 | std::size_t(size[2]) << 16 | std::size_t(size[3]) << 24;
  }

  void read_header(const NpyColumns& columns) {
    at_ = npy_magic.size();
    const std::size_t size = header_size();
    const std::uint64_t begin = at_;
    if (size > max_header_bytes) fail(begin, "the header is longer than 65536 bytes");
    std::string header(size, ' ');
    read(header.data(), size);
    data_ = at_;
    const std::string_view type = value_of(header, "descr");
    if (!type.starts_with("'<f8'"))
      fail(begin, "expected little-endian float64 ('<f8'), got " +
                      std::string(type.substr(0, std::min<std::size_t>(type.find(','), 40))));
    if (!value_of(header, "fortran_order").starts_with("False"))
      fail(begin, "expected rows that are contiguous (C order, numpy.ascontiguousarray)");
    const bool is_table = read_shape(value_of(header, "shape"), shape_);
    if (!is_table || (shape_.columns != columns.count && shape_.columns != columns.count_with_direction) ||
        shape_.columns == 0)
      fail(begin, "expected an array of two dimensions with " + columns.expected);
    if (shape_.rows > std::uint64_t(1) << 48) fail(begin, "more than 2^48 rows");
  }

  std::filesystem::path path_;
  std::unique_ptr<std::FILE, QueryFile::Close> file_;
  const ThreadPool& pool_;
  QueryKind kind_;
  NpyShape shape_;
  std::uint64_t at_ = 0, data_ = 0;    ///< at_: bytes read so far; data_: byte offset of the first row
  std::uint64_t row_ = 0, first_ = 0;  ///< row_: the next row; first_: the first row of the last next()
  std::vector<double> numbers_;
};

template <class T>
void put(const T& value, std::string& bytes) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

QueryFile open_query_file(const std::filesystem::path& path) {
  QueryFile opened{path == "-" ? std::filesystem::path("standard input") : path, nullptr};
  opened.file.reset(path == "-" ? stdin : std::fopen(path.c_str(), "rb"));
  if (!opened.file) throw InputError(path, "", std::strerror(errno));
  return opened;
}

std::unique_ptr<QuerySource> npy_queries(QueryFile file, QueryKind kind, QueryFrame frame, const ThreadPool& pool) {
  return std::make_unique<NpyQueries>(std::move(file), kind, frame, pool);
}

std::string npy_header(QueryKind kind, QueryFrame frame, std::uint64_t count, bool has_classes) {
  constexpr std::size_t alignment = 64, before_text = 10;
  const char* height = frame == QueryFrame::crs ? "height" : "height_m";  // heights of a system may be in feet
  std::string text = std::string("{'descr': [('") + (kind == QueryKind::height ? height : "distance_m") +
                     "', '<f8'), ('normal', '<f4', (3,)), ('rgba', '|u1', (4,)), ('outcome', '|u1'), ('lod', '|i1')" +
                     (has_classes ? ", ('class', '<u2')" : "") + "], 'fortran_order': False, 'shape': (" +
                     std::to_string(count) + ",), }";
  text.append(alignment - 1 - (before_text + text.size()) % alignment, ' ');
  text += '\n';
  std::string header(npy_magic);
  header += '\x01';
  header += '\0';
  put(std::uint16_t(text.size()), header);
  return header + text;
}

void add_npy(const QueryAnswer& answer, QueryKind kind, const QueryFrames& frames, bool has_classes,
             std::string& bytes) {
  const QueryHit& hit = answer.hit;
  const bool is_hit = hit.outcome == QueryOutcome::hit;
  double length = frames.metres(hit.distance);
  if (kind == QueryKind::height)
    length = is_hit ? frames.point_in_query_frame(frames.scene_point(answer.ray, hit.distance))[2]
                    : std::numeric_limits<double>::quiet_NaN();
  double normal[3] = {};
  if (is_hit) decode_octahedral(hit.normal, normal);
  put(length, bytes);
  for (const double n : normal) put(float(n), bytes);
  put(hit.rgba, bytes);
  put(std::uint8_t(hit.outcome), bytes);
  put(std::int8_t(is_hit ? hit.lod : -1), bytes);
  if (has_classes) put(hit.voxel_class, bytes);
}

}  // namespace gigabake
