#include <algorithm>
#include <hdf5.h>
#include <vector>

#include "format/chunk_codec.h"
#include "format/hdf5_file.h"
#include "format/hdf5_types.h"
#include "format/parallel.h"

namespace gigabake {
namespace {

constexpr H5Z_filter_t lz4_filter = 32004;
// Pages of 128 KiB read well from disks; HDF5 slows down beyond a few thousand chunks, so large columns get larger
// ones.
constexpr std::size_t chunk_bytes = 128 << 10, most_chunks = 1024, chunks_in_hand = 64;
constexpr std::size_t largest_chunk = std::size_t(1) << 31;
constexpr std::uint64_t lz4_best_ratio = 255;

int rank(const Hdf5Column& column) { return column.width == 1 ? 1 : 2; }

std::size_t rows_per_chunk(std::size_t rows, std::size_t row_bytes) {
  const std::size_t wanted = std::max(chunk_bytes / row_bytes, (rows + most_chunks - 1) / most_chunks);
  return std::clamp<std::size_t>(wanted, 1, rows);
}

Hdf5Id creation_properties(const Hdf5Call& call, const Hdf5Column& column, std::size_t rows) {
  Hdf5Id create = call.id("H5Pcreate", H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  call("H5Pset_obj_track_times", H5Pset_obj_track_times(create.get(), false));
  if (rows == 0) return create;
  const hsize_t chunk[2] = {rows_per_chunk(rows, column.row_bytes()), column.width};
  call("H5Pset_chunk", H5Pset_chunk(create.get(), rank(column), chunk));
  call("H5Pset_filter", H5Pset_filter(create.get(), lz4_filter, H5Z_FLAG_OPTIONAL, 0, nullptr));
  call("H5Pset_fletcher32", H5Pset_fletcher32(create.get()));
  return create;
}

/// Chunk `index` of the data, zeros after its end: stored chunks are always whole.
std::vector<std::uint8_t> encode_rows(std::span<const std::uint8_t> data, std::size_t whole_bytes, std::size_t index) {
  const auto rest = data.subspan(index * whole_bytes);
  if (rest.size() >= whole_bytes) return encode_chunk(rest.first(whole_bytes));
  std::vector<std::uint8_t> padded(whole_bytes, 0);
  std::copy(rest.begin(), rest.end(), padded.begin());
  return encode_chunk(padded);
}

/// Rows a chunk; the whole dataset's chunks are alike.
std::size_t chunk_rows(const Hdf5File& file, const Hdf5Call& call, const Hdf5Column& column, const Hdf5Id& set,
                       std::size_t rows) {
  const Hdf5Id properties = call.id("H5Dget_create_plist", H5Dget_create_plist(set.get()), H5Pclose);
  hsize_t chunk[2] = {0, column.width};
  if (call("H5Pget_layout", H5Pget_layout(properties.get())) != H5D_CHUNKED ||
      call("H5Pget_chunk", H5Pget_chunk(properties.get(), rank(column), chunk)) != rank(column) || chunk[0] == 0 ||
      chunk[0] > rows || chunk[0] > largest_chunk / column.row_bytes() || chunk[1] != column.width)
    file.fail(column.name, "is not stored in the chunks that were expected");
  return chunk[0];
}

void read_chunk(const Hdf5File& file, const Hdf5Call& call, const Hdf5Id& set, std::size_t row,
                std::vector<std::uint8_t>& stored, std::span<std::uint8_t> raw) {
  const hsize_t offset[2] = {row, 0};
  hsize_t bytes = 0;
  const std::string where = "row " + std::to_string(row) + ": ";
  call("H5Dget_chunk_storage_size", H5Dget_chunk_storage_size(set.get(), offset, &bytes));
  if (bytes == 0 || bytes > raw.size() + raw.size() / 8 + 4096)
    file.fail(call.object, where + "the chunk is missing or damaged; bake the cell again");
  stored.resize(bytes);
  std::uint32_t skipped_filters = 0;
  call("H5Dread_chunk", H5Dread_chunk(set.get(), H5P_DEFAULT, offset, &skipped_filters, stored.data()));
  if (skipped_filters != 0 || !decode_chunk(stored, raw))
    file.fail(call.object, where + "the checksum is wrong: the file is damaged; bake the cell again");
}

}  // namespace

Hdf5Id Hdf5File::open_column(const Hdf5Column& column) const {
  return Hdf5Call{path_, column.name}.id("H5Dopen2", H5Dopen2(file_.get(), column.name.c_str(), H5P_DEFAULT), H5Dclose);
}

void Hdf5File::write_column(const Hdf5Column& column, const void* data, std::size_t rows, int threads) {
  const Hdf5Call call{path_, column.name};
  const hsize_t shape[2] = {rows, column.width};
  const Hdf5Id space = call.id("H5Screate_simple", H5Screate_simple(rank(column), shape, nullptr), H5Sclose);
  const Hdf5Id properties = creation_properties(call, column, rows);
  const Hdf5Id set = call.id("H5Dcreate2",
                             H5Dcreate2(file_.get(), column.name.c_str(), hdf5_type(column.type), space.get(),
                                        H5P_DEFAULT, properties.get(), H5P_DEFAULT),
                             H5Dclose);
  if (rows == 0) return;
  const std::span bytes(static_cast<const std::uint8_t*>(data), rows * column.row_bytes());
  const std::size_t per_chunk = rows_per_chunk(rows, column.row_bytes());
  const std::size_t chunks = (rows + per_chunk - 1) / per_chunk;
  for (std::size_t first = 0; first < chunks; first += chunks_in_hand) {
    std::vector<std::vector<std::uint8_t>> encoded(std::min(chunks_in_hand, chunks - first));
    parallel_ranges(encoded.size(), 1, threads, [&](std::size_t i, std::size_t) {
      encoded[i] = encode_rows(bytes, per_chunk * column.row_bytes(), first + i);
    });
    for (std::size_t i = 0; i < encoded.size(); ++i) {
      const hsize_t offset[2] = {(first + i) * per_chunk, 0};
      call("H5Dwrite_chunk", H5Dwrite_chunk(set.get(), H5P_DEFAULT, 0, offset, encoded[i].size(), encoded[i].data()));
    }
  }
}

std::size_t Hdf5File::column_rows(const Hdf5Column& column) const {
  const Hdf5Call call{path_, column.name};
  const Hdf5Id set = open_column(column);
  const Hdf5Id space = call.id("H5Dget_space", H5Dget_space(set.get()), H5Sclose);
  const Hdf5Id type = call.id("H5Dget_type", H5Dget_type(set.get()), H5Tclose);
  hsize_t shape[2] = {0, 1};
  if (call("H5Sget_simple_extent_ndims", H5Sget_simple_extent_ndims(space.get())) != rank(column))
    fail(column.name, "has another shape than expected");
  call("H5Sget_simple_extent_dims", H5Sget_simple_extent_dims(space.get(), shape, nullptr));
  if (shape[1] != column.width) fail(column.name, "has another shape than expected");
  if (call("H5Tequal", H5Tequal(type.get(), hdf5_type(column.type))) == 0)
    fail(column.name, "has another type than expected");
  // A damaged shape must not make us allocate more than the stored bytes can unpack to.
  if (shape[0] > H5Dget_storage_size(set.get()) * lz4_best_ratio / column.row_bytes())
    fail(column.name, "says it has " + std::to_string(shape[0]) + " rows, more than what is stored can hold");
  return shape[0];
}

void Hdf5File::read_column(const Hdf5Column& column, void* data, std::size_t rows) const {
  if (rows == 0) return;
  const Hdf5Call call{path_, column.name};
  const Hdf5Id set = open_column(column);
  const std::size_t per_chunk = chunk_rows(*this, call, column, set, rows), row_bytes = column.row_bytes();
  std::vector<std::uint8_t> stored, raw(per_chunk * row_bytes);
  auto* to = static_cast<std::uint8_t*>(data);
  for (std::size_t row = 0; row < rows; row += per_chunk) {
    read_chunk(*this, call, set, row, stored, raw);
    std::copy_n(raw.begin(), std::min(per_chunk, rows - row) * row_bytes, to + row * row_bytes);
  }
}

std::uint64_t Hdf5File::stored_bytes(const Hdf5Column& column) const {
  return H5Dget_storage_size(open_column(column).get());
}

}  // namespace gigabake
