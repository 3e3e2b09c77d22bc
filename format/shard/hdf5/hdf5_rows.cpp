#include "format/shard/hdf5/hdf5_rows.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <hdf5.h>
#include <unistd.h>
#include <vector>

#include "core/base/pluralize.h"
#include "format/shard/hdf5/chunk_cache.h"
#include "format/shard/hdf5/chunk_codec.h"
#include "format/shard/hdf5/hdf5_types.h"

namespace gigabake {
namespace {

constexpr std::uint64_t max_chunk_bytes = std::uint64_t(1) << 31;
/// Larger chunks are not kept, because few of them would fill the cache.
constexpr std::uint64_t max_kept_bytes = std::uint64_t(1) << 20;
/// The max number of chunks that are all located when the column is opened. HDF5's time to locate a chunk is
/// proportional to the chunk's index.
constexpr std::uint64_t max_located = 16;

/// Returns the max number of bytes that one stored byte can expand to.
std::uint64_t max_expansion_ratio(Codec codec) { return codec == Codec::lz4 ? 255 : 1032; }

/// Returns the filters of the dataset. Rejects filters that chunk_codec.h cannot undo. Accepted are an optional
/// shuffle, then LZ4 or deflate, then the checksum.
ChunkFilters checked_filters(const Hdf5File& file, const Hdf5Column& column, const Hdf5Id& properties) {
  const Hdf5Call call{file.path(), column.name};
  std::vector<H5Z_filter_t> found;
  const int count = call("H5Pget_nfilters", H5Pget_nfilters(properties.get()));
  for (int i = 0; i < count; ++i) {
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    found.push_back(call("H5Pget_filter2",
                         H5Pget_filter2(properties.get(), unsigned(i), &flags, &values, nullptr, 0, nullptr, &config)));
  }
  for (const Codec codec : {Codec::lz4, Codec::deflate}) {
    const H5Z_filter_t packed = codec == Codec::lz4 ? lz4_filter : H5Z_FILTER_DEFLATE;
    if (found == std::vector{packed, H5Z_FILTER_FLETCHER32}) return {codec, 1};
    if (found == std::vector{H5Z_FILTER_SHUFFLE, packed, H5Z_FILTER_FLETCHER32})
      return {codec, column.planes == BytePlanes::of_rows ? column.row_bytes() : element_bytes(column.type)};
  }
  file.fail(column.name, "is not stored with the expected filters");
}

/// Returns the number of rows that the dataset states.
std::uint64_t checked_rows(const Hdf5File& file, const Hdf5Column& column, const Hdf5Id& set) {
  const Hdf5Call call{file.path(), column.name};
  const Hdf5Id space = call.id("H5Dget_space", H5Dget_space(set.get()), H5Sclose);
  const Hdf5Id type = call.id("H5Dget_type", H5Dget_type(set.get()), H5Tclose);
  hsize_t shape[H5S_MAX_RANK] = {};
  const int dimensions = call("H5Sget_simple_extent_dims", H5Sget_simple_extent_dims(space.get(), shape, nullptr));
  if (dimensions != column.dimensions() || (dimensions == 2 && shape[1] != column.width))
    file.fail(column.name, "has another shape than expected");
  if (call("H5Tequal", H5Tequal(type.get(), hdf5_type(call, column))) == 0)
    file.fail(column.name, "has another type than expected");
  return shape[0];
}

/// Rejects a damaged shape whose rows would need more memory than the stored bytes can expand to.
void check_expansion(const Hdf5File& file, const Hdf5Column& column, std::uint64_t rows, std::uint64_t stored_bytes,
                     Codec codec) {
  if (stored_bytes > file.bytes()) file.fail(column.name, "states a stored size that exceeds the size of the file");
  if (rows > stored_bytes * max_expansion_ratio(codec) / column.row_bytes())
    file.fail(column.name, "states " + pluralize(rows, "row") + ", more than its stored bytes can hold");
}

/// Returns the number of rows per chunk, which is the same for all chunks of the dataset.
std::uint64_t checked_chunk_rows(const Hdf5File& file, const Hdf5Column& column, const OpenColumn& open,
                                 std::uint64_t rows) {
  const Hdf5Call call{file.path(), column.name};
  const std::size_t width = column.dimensions() == 1 ? 1 : column.width;
  hsize_t chunk[2] = {0, width};
  if (!open.is_chunked ||
      call("H5Pget_chunk", H5Pget_chunk(open.properties.get(), column.dimensions(), chunk)) != column.dimensions() ||
      chunk[0] == 0 || chunk[0] > rows || chunk[0] > max_chunk_bytes / column.row_bytes() || chunk[1] != width)
    file.fail(column.name, "is not stored in the expected chunks");
  return chunk[0];
}

/// Fills `to` with the bytes at `offset`. Returns false if the file is too short (errno is then 0) or cannot be read.
bool read_bytes(int descriptor, std::uint64_t offset, std::span<std::uint8_t> to) {
  while (!to.empty()) {
    errno = 0;
    const ssize_t got = ::pread(descriptor, to.data(), to.size(), off_t(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    offset += std::uint64_t(got);
    to = to.subspan(std::size_t(got));
  }
  return true;
}

}  // namespace

Hdf5Rows::Hdf5Rows(const Hdf5File& file, const Hdf5Column& column)
    : file_(file), column_(column), number_(file.chunks() != nullptr ? file.chunks()->add_column() : 0) {
  const Hdf5Call call{file.path(), column.name};
  OpenColumn open = file.open_column(column);
  rows_ = checked_rows(file, column, open.set);
  if (rows_ == 0) return;
  filters_ = checked_filters(file, column, open.properties);
  chunk_rows_ = checked_chunk_rows(file, column, open, rows_);
  const std::uint64_t chunks = 1 + (rows_ - 1) / chunk_rows_;
  if (chunks > max_located) {
    set_.emplace(std::move(open.set));
    check_expansion(file, column, rows_, H5Dget_storage_size(set_->get()), filters_.codec);
    return;
  }
  std::uint64_t stored_bytes = 0;
  for (std::uint64_t index = 0; index < chunks; ++index) {
    const Chunk chunk = chunks_[index] = locate(call, open.set, index);
    stored_bytes += std::min(chunk.bytes, file.bytes());
  }
  check_expansion(file, column, rows_, stored_bytes, filters_.codec);
}

void Hdf5Rows::fail_chunk(std::uint64_t index, const char* message) const {
  file_.fail(column_.name, "row " + std::to_string(index * chunk_rows_) + ": " + message + "; bake the cell again");
}

Hdf5Rows::Chunk Hdf5Rows::locate(const Hdf5Call& call, const Hdf5Id& set, std::uint64_t index) const {
  const hsize_t row[2] = {index * chunk_rows_, 0};
  unsigned skipped_filters = 0;
  haddr_t offset = 0;
  hsize_t bytes = 0;
  call("H5Dget_chunk_info_by_coord", H5Dget_chunk_info_by_coord(set.get(), row, &skipped_filters, &offset, &bytes));
  return {offset, bytes, skipped_filters == 0};
}

Hdf5Rows::Chunk Hdf5Rows::find_chunk(std::uint64_t index) const {
  const std::scoped_lock lock(mutex_);
  auto found = chunks_.find(index);
  if (found == chunks_.end()) {
    const Hdf5Call call{file_.path(), column_.name};
    configure_hdf5(call);
    found = chunks_.emplace(index, locate(call, *set_, index)).first;
  }
  const auto [offset, bytes, is_filtered] = found->second;
  const std::uint64_t raw_bytes = chunk_rows_ * column_.row_bytes();
  if (!is_filtered || bytes == 0 || bytes > raw_bytes + raw_bytes / 8 + 4096 || bytes > file_.bytes() ||
      offset > file_.bytes() - bytes)
    fail_chunk(index, "the chunk is missing or damaged");
  return found->second;
}

std::vector<std::uint8_t> Hdf5Rows::bytes_of_chunk(std::uint64_t index) const {
  const Chunk chunk = find_chunk(index);
  std::vector<std::uint8_t> stored(chunk.bytes);
  file_.add_read_bytes(chunk.bytes);
  if (!read_bytes(file_.descriptor(), chunk.offset, stored))
    fail_chunk(index, errno == 0 ? "the file ends before it" : std::strerror(errno));
  return stored;
}

void Hdf5Rows::read_chunk(std::uint64_t index, std::span<std::uint8_t> raw) const {
  if (!decode_chunk(bytes_of_chunk(index), filters_, chunk_rows_ * column_.row_bytes(), raw))
    fail_chunk(index, "the checksum is wrong: the file is damaged");
}

std::vector<std::uint8_t> Hdf5Rows::stored_chunk(std::uint64_t index) const {
  std::vector<std::uint8_t> stored = bytes_of_chunk(index);
  if (!has_valid_checksum(stored)) fail_chunk(index, "the checksum is wrong: the file is damaged");
  return stored;
}

void Hdf5Rows::read(std::uint64_t first, std::uint64_t count, void* to) const {
  file_.add_read_rows(count);
  if (file_.chunks() != nullptr && chunk_rows_ * column_.row_bytes() <= max_kept_bytes)
    return read_from_cache(first, count, static_cast<std::uint8_t*>(to));
  read_chunked_rows(first, count, chunk_rows_, column_.row_bytes(), to,
                    [this](std::uint64_t index, std::span<std::uint8_t> raw) { read_chunk(index, raw); });
}

void Hdf5Rows::read_from_cache(std::uint64_t first, std::uint64_t count, std::uint8_t* to) const {
  const std::size_t row_bytes = column_.row_bytes();
  for_each_chunk_of_rows(first, count, chunk_rows_, [&](std::uint64_t index, std::uint64_t before, std::uint64_t rows) {
    const auto chunk = file_.chunks()->get(number_, index, [&] {
      auto unpacked = std::make_shared<ChunkCache::Chunk>();
      unpacked->raw.resize(chunk_rows_ * row_bytes);
      read_chunk(index, unpacked->raw);
      return unpacked;
    });
    to = std::copy_n(chunk->raw.begin() + std::ptrdiff_t(before * row_bytes), rows * row_bytes, to);
  });
}

}  // namespace gigabake
