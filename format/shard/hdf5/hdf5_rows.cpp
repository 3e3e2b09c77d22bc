#include "format/shard/hdf5/hdf5_rows.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <unistd.h>
#include <utility>
#include <vector>

#include "core/base/pluralize.h"
#include "format/shard/hdf5/chunk_cache.h"
#include "format/shard/hdf5/chunk_codec.h"

namespace gigabake {
namespace {

constexpr std::uint64_t max_chunk_bytes = std::uint64_t(1) << 31;
/// Larger chunks are not kept, because few of them would fill the cache.
constexpr std::uint64_t max_kept_bytes = std::uint64_t(1) << 20;
/// The max number of chunks that HDF5 locates when the column is opened. Its time to locate a chunk is proportional to
/// the chunk's index.
constexpr std::uint64_t max_located = 16;

/// Returns the max number of bytes that one stored byte can expand to.
std::uint64_t max_expansion_ratio(Codec codec) { return codec == Codec::lz4 ? 255 : 1032; }

/// Rejects a damaged shape whose rows would need more memory than the stored bytes can expand to.
void check_expansion(const Hdf5File& file, const Hdf5Column& column, std::uint64_t rows, std::uint64_t stored_bytes,
                     Codec codec) {
  if (stored_bytes > file.bytes()) file.fail(column.name, "states a stored size that exceeds the size of the file");
  if (rows > stored_bytes * max_expansion_ratio(codec) / column.row_bytes())
    file.fail(column.name, "states " + pluralize(rows, "row") + ", more than its stored bytes can hold");
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

std::uint64_t number_in_cache(const Hdf5File& file) {
  return file.chunks() != nullptr ? file.chunks()->add_column() : 0;
}

}  // namespace

Hdf5Rows::Hdf5Rows(const Hdf5File& file, const Hdf5Column& column)
    : file_(file), column_(column), number_(number_in_cache(file)) {
  if (const ChunkTable* table = file.chunk_table()) {
    shape_ = table->find(column.name);
    if (shape_ == nullptr) file.fail(column.name, "is missing; bake the cell again");
  } else {
    locate_by_index(IndexedColumn(file, column));
  }
  accept_shape();
}

Hdf5Rows::Hdf5Rows(const Hdf5File& file, const Hdf5Column& column, IndexedColumn index)
    : file_(file), column_(column), number_(number_in_cache(file)) {
  locate_by_index(std::move(index));
  accept_shape();
}

void Hdf5Rows::locate_by_index(IndexedColumn index) {
  if (index.shape().chunk_count() <= max_located) {
    found_ = index.with_chunks();
  } else {
    found_ = index.shape();
    index_.emplace(std::move(index));
  }
  shape_ = &found_;
}

void Hdf5Rows::accept_shape() {
  if (shape_->row_bytes != column_.row_bytes()) file_.fail(column_.name, "has another shape than expected");
  if (shape_->rows == 0) return;
  if (shape_->chunk_rows > shape_->rows || shape_->chunk_rows > max_chunk_bytes / shape_->row_bytes)
    file_.fail(column_.name, "is not stored in the expected chunks");
  std::uint64_t stored_bytes = index_ ? index_->stored_bytes() : 0;
  for (const ChunkPlace& chunk : shape_->chunks) stored_bytes += std::min(chunk.bytes, file_.bytes());
  check_expansion(file_, column_, shape_->rows, stored_bytes, shape_->codec);
  filters_ = {shape_->codec, shape_->is_shuffled ? column_.item_bytes() : 1};
}

void Hdf5Rows::fail_chunk(std::uint64_t index, const char* message) const {
  file_.fail(column_.name,
             "row " + std::to_string(index * shape_->chunk_rows) + ": " + message + "; bake the cell again");
}

ChunkPlace Hdf5Rows::find_chunk(std::uint64_t index) const {
  ChunkPlace place;
  if (!index_) {
    place = shape_->chunks[index];
  } else {
    const std::scoped_lock lock(mutex_);
    auto found = located_.find(index);
    if (found == located_.end()) found = located_.emplace(index, index_->locate(index)).first;
    place = found->second;
  }
  const std::uint64_t raw_bytes = raw_chunk_bytes();
  if (place.bytes == 0 || place.bytes > raw_bytes + raw_bytes / 8 + 4096 || place.bytes > file_.bytes() ||
      place.offset > file_.bytes() - place.bytes)
    fail_chunk(index, "the chunk is missing or damaged");
  return place;
}

std::vector<std::uint8_t> Hdf5Rows::bytes_of_chunk(std::uint64_t index) const {
  const ChunkPlace chunk = find_chunk(index);
  std::vector<std::uint8_t> stored(chunk.bytes);
  file_.add_read_bytes(chunk.bytes);
  if (!read_bytes(file_.descriptor(), chunk.offset, stored))
    fail_chunk(index, errno == 0 ? "the file ends before it" : std::strerror(errno));
  return stored;
}

void Hdf5Rows::read_chunk(std::uint64_t index, std::span<std::uint8_t> raw) const {
  if (!decode_chunk(bytes_of_chunk(index), filters_, raw_chunk_bytes(), raw))
    fail_chunk(index, "the checksum is wrong: the file is damaged");
}

std::vector<std::uint8_t> Hdf5Rows::stored_chunk(std::uint64_t index) const {
  std::vector<std::uint8_t> stored = bytes_of_chunk(index);
  if (!has_valid_checksum(stored)) fail_chunk(index, "the checksum is wrong: the file is damaged");
  return stored;
}

void Hdf5Rows::read(std::uint64_t first, std::uint64_t count, void* to) const {
  file_.add_read_rows(count);
  if (file_.chunks() != nullptr && raw_chunk_bytes() <= max_kept_bytes)
    return read_from_cache(first, count, static_cast<std::uint8_t*>(to));
  read_chunked_rows(first, count, shape_->chunk_rows, shape_->row_bytes, to,
                    [this](std::uint64_t index, std::span<std::uint8_t> raw) { read_chunk(index, raw); });
}

void Hdf5Rows::read_from_cache(std::uint64_t first, std::uint64_t count, std::uint8_t* to) const {
  const std::size_t row_bytes = column_.row_bytes();
  for_each_chunk_of_rows(
      first, count, shape_->chunk_rows, [&](std::uint64_t index, std::uint64_t before, std::uint64_t rows) {
        const auto chunk = file_.chunks()->get(number_, index, [&] {
          auto unpacked = std::make_shared<ChunkCache::Chunk>();
          unpacked->raw.resize(raw_chunk_bytes());
          read_chunk(index, unpacked->raw);
          return unpacked;
        });
        to = std::copy_n(chunk->raw.begin() + std::ptrdiff_t(before * row_bytes), rows * row_bytes, to);
      });
}

}  // namespace gigabake
