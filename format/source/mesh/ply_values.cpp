#include "format/source/mesh/ply_values.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>

#include "core/base/error.h"
#include "core/base/pluralize.h"
#include "format/source/source_file.h"

namespace gigabake {
namespace {

static_assert(std::endian::native == std::endian::little);

template <class T>
double value_at(const std::array<std::uint8_t, 8>& bytes) {
  T v;
  std::memcpy(&v, bytes.data(), sizeof v);
  return double(v);
}

}  // namespace

void PlyValues::fail(const std::string& message) const {
  if (format_ == PlyFormat::ascii) throw InputError(file_, "line " + std::to_string(line_), message);
  throw InputError(file_, "", message, at_);
}

double PlyValues::binary(PlyType type) {
  const std::size_t size = byte_count(type);
  if (make_available(size) < size) fail("the file ends inside its elements");
  std::array<std::uint8_t, 8> bytes{};
  for (std::size_t i = 0; i < size; ++i)
    bytes[i] = byte_at(at_ + (format_ == PlyFormat::big_endian ? size - 1 - i : i));
  at_ += size;
  switch (type) {
    case PlyType::int8:
      return value_at<std::int8_t>(bytes);
    case PlyType::uint8:
      return value_at<std::uint8_t>(bytes);
    case PlyType::int16:
      return value_at<std::int16_t>(bytes);
    case PlyType::uint16:
      return value_at<std::uint16_t>(bytes);
    case PlyType::int32:
      return value_at<std::int32_t>(bytes);
    case PlyType::uint32:
      return value_at<std::uint32_t>(bytes);
    case PlyType::float32:
      return value_at<float>(bytes);
    default:
      return value_at<double>(bytes);
  }
}

std::size_t PlyValues::make_available(std::size_t bytes) {
  const std::uint64_t wanted = std::min<std::uint64_t>(bytes, left());
  if (at_ < block_begin_ || at_ + wanted > block_begin_ + block_.size()) {
    block_ =
        bytes_.look(at_, std::min<std::uint64_t>(std::max<std::uint64_t>(wanted, read_block_bytes), left()), buffer_);
    block_begin_ = at_;
  }
  return std::size_t(block_begin_ + block_.size() - at_);
}

std::size_t PlyValues::skip_blanks() {
  std::size_t available = make_available(1);
  for (; available > 0 && byte_at(at_) <= ' '; available = make_available(1)) {
    line_ += byte_at(at_) == '\n' ? 1 : 0;
    ++at_;
  }
  return available;
}

std::uint64_t PlyValues::bytes_after() {
  if (format_ == PlyFormat::ascii) skip_blanks();
  return left();
}

double PlyValues::word() {
  constexpr std::size_t max_word_bytes = std::size_t(1) << 20;
  std::size_t available = skip_blanks();
  std::size_t length = 0;
  while (length < available && byte_at(at_ + length) > ' ')
    if (++length == available && length < max_word_bytes) available = make_available(length + 1);
  if (length == 0) fail("the file ends inside its elements");
  std::string_view text(reinterpret_cast<const char*>(block_.data()) + (at_ - block_begin_), length);
  if (text.starts_with('+')) text.remove_prefix(1);
  double v = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), v);
  if (parsed.ptr != text.data() + text.size() || parsed.ec == std::errc::invalid_argument)
    fail("expected a number, got " + in_quotes(text));
  if (parsed.ec == std::errc::result_out_of_range && text.find("e-") == text.npos && text.find("E-") == text.npos)
    v = HUGE_VAL;
  at_ += length;
  return v;
}

std::uint64_t PlyValues::length(const PlyProperty& list) {
  const double items = number(*list.count);
  const std::uint64_t item_bytes = format_ == PlyFormat::ascii ? 2 : byte_count(list.type);
  // One byte is added, because the last value in a text needs no space after it.
  if (!(items >= 0) || items != std::floor(items) || items * double(item_bytes) > double(left() + 1))
    fail("expected the length of a list that fits in the file");
  return std::uint64_t(items);
}

void PlyValues::skip(const PlyProperty& property) {
  for (std::uint64_t n = property.count ? length(property) : 1; n > 0; --n) number(property.type);
}

void PlyValues::expect_room_for(const PlyElement& element) const {
  std::uint64_t min_bytes = 0;
  for (const PlyProperty& p : element.properties)
    min_bytes += format_ == PlyFormat::ascii ? 2 : byte_count(p.count.value_or(p.type));
  if (min_bytes != 0 && element.count > (left() + 1) / min_bytes)
    fail("the header states " + pluralize(element.count, "element") + " " + in_quotes(element.name) +
         ", more than the file can hold");
}

}  // namespace gigabake
