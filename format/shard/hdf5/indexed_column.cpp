#include "format/shard/hdf5/indexed_column.h"

#include <hdf5.h>
#include <utility>
#include <vector>

#include "format/shard/hdf5/hdf5_types.h"

namespace gigabake {
namespace {

/// Adds the filters of the dataset. Rejects filters that chunk_codec.h cannot undo. Accepted are an optional shuffle,
/// then LZ4 or deflate, then the checksum.
void add_filters(const Hdf5File& file, const Hdf5Column& column, const Hdf5Id& properties, ChunkedColumn& shape) {
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
    shape.codec = codec;
    shape.is_shuffled = found == std::vector{H5Z_FILTER_SHUFFLE, packed, H5Z_FILTER_FLETCHER32};
    if (shape.is_shuffled || found == std::vector{packed, H5Z_FILTER_FLETCHER32}) return;
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

/// Returns the number of rows per chunk, which is the same for all chunks of the dataset.
std::uint64_t checked_chunk_rows(const Hdf5File& file, const Hdf5Column& column, const OpenColumn& open) {
  const Hdf5Call call{file.path(), column.name};
  const std::size_t width = column.dimensions() == 1 ? 1 : column.width;
  hsize_t chunk[2] = {0, width};
  if (!open.is_chunked ||
      call("H5Pget_chunk", H5Pget_chunk(open.properties.get(), column.dimensions(), chunk)) != column.dimensions() ||
      chunk[0] == 0 || chunk[1] != width)
    file.fail(column.name, "is not stored in the expected chunks");
  return chunk[0];
}

ChunkedColumn checked_shape(const Hdf5File& file, const Hdf5Column& column, const OpenColumn& open) {
  ChunkedColumn shape;
  shape.rows = checked_rows(file, column, open.set);
  shape.row_bytes = column.row_bytes();
  if (shape.rows == 0) return shape;
  add_filters(file, column, open.properties, shape);
  shape.chunk_rows = checked_chunk_rows(file, column, open);
  return shape;
}

}  // namespace

IndexedColumn::IndexedColumn(const Hdf5File& file, const Hdf5Column& column)
    : IndexedColumn(file, column, file.open_column(column)) {}

IndexedColumn::IndexedColumn(const Hdf5File& file, const Hdf5Column& column, OpenColumn open)
    : file_(file), column_(column), shape_(checked_shape(file, column, open)), set_(std::move(open.set)) {}

ChunkPlace IndexedColumn::locate(std::uint64_t index) const {
  const Hdf5Call call{file_.path(), column_.name};
  configure_hdf5(call);
  const hsize_t row[2] = {index * shape_.chunk_rows, 0};
  unsigned skipped_filters = 0;
  haddr_t offset = 0;
  hsize_t bytes = 0;
  call("H5Dget_chunk_info_by_coord", H5Dget_chunk_info_by_coord(set_.get(), row, &skipped_filters, &offset, &bytes));
  return {offset, skipped_filters == 0 ? bytes : 0};
}

ChunkedColumn IndexedColumn::with_chunks() const {
  ChunkedColumn all = shape_;
  for (std::uint64_t index = 0; index < all.chunk_count(); ++index) all.chunks.push_back(locate(index));
  return all;
}

bool IndexedColumn::matches(const ChunkedColumn& listed) const {
  ChunkedColumn shape = listed;
  shape.chunks.clear();
  return shape == shape_ && with_chunks() == listed;
}

std::uint64_t IndexedColumn::stored_bytes() const { return H5Dget_storage_size(set_.get()); }

}  // namespace gigabake
