#include <array>
#include <hdf5.h>
#include <optional>
#include <utility>

#include "core/codec/chunk_rows.h"
#include "format/shard/hdf5/hdf5_file.h"
#include "format/shard/hdf5/hdf5_types.h"

namespace gigabake {
namespace {

/// Makes the creation properties of columns with these filters. Columns without rows have no `codec`.
hid_t made_properties(const Hdf5Call& call, bool is_shuffled, std::optional<Codec> codec) {
  const hid_t create = call("H5Pcreate", H5Pcreate(H5P_DATASET_CREATE));
  call("H5Pset_obj_track_times", H5Pset_obj_track_times(create, false));
  if (!codec) return create;
  if (is_shuffled) call("H5Pset_shuffle", H5Pset_shuffle(create));
  if (*codec == Codec::lz4)
    call("H5Pset_filter", H5Pset_filter(create, lz4_filter, H5Z_FLAG_OPTIONAL, 0, nullptr));
  else
    call("H5Pset_deflate", H5Pset_deflate(create, 1));
  call("H5Pset_fletcher32", H5Pset_fletcher32(create));
  return create;
}

/// Returns the creation properties of a column. They are valid until the turn of `call` ends. Columns with the same
/// filters share properties, which are never closed: making a list per column takes a sixth of the time of a shard.
hid_t creation_properties(const Hdf5Call& call, const Hdf5Column& column, std::size_t rows, Codec codec) {
  static std::array<hid_t, 5> made{};  // guarded by the turn; 0: not made yet
  const bool is_shuffled = column.planes != BytePlanes::no;
  const std::size_t number = rows == 0 ? 0 : 1 + (is_shuffled ? 1 : 0) + (codec == Codec::lz4 ? 2 : 0);
  hid_t& create = made[number];
  if (create == 0) create = made_properties(call, is_shuffled, rows == 0 ? std::nullopt : std::optional(codec));
  if (rows == 0) return create;
  const hsize_t chunk[2] = {rows_per_chunk(rows, column.row_bytes()), column.width};
  call("H5Pset_chunk", H5Pset_chunk(create, column.dimensions(), chunk));
  return create;
}

/// Returns the shape of a column that is written, without chunks.
ChunkedColumn shape_in_file(const Hdf5Column& column, std::uint64_t rows, Codec codec) {
  if (rows == 0) return {0, 0, column.row_bytes(), Codec::lz4, false, {}};
  return {rows,  rows_per_chunk(rows, column.row_bytes()), column.row_bytes(),
          codec, column.planes != BytePlanes::no,          {}};
}

}  // namespace

OpenColumn Hdf5File::open_column(const Hdf5Column& column) const {
  const Hdf5Call call{path_, column.name};
  configure_hdf5(call);
  count_work(WorkCounter::shard_datasets_opened);
  Hdf5Id set = call.id("H5Dopen2", H5Dopen2(file_.get(), column.name.c_str(), H5P_DEFAULT), H5Dclose);
  // The layout is checked before the shape, because reading the shape of a virtual dataset opens the files that the
  // dataset refers to.
  Hdf5Id properties = call.id("H5Dget_create_plist", H5Dget_create_plist(set.get()), H5Pclose);
  const H5D_layout_t layout = call("H5Pget_layout", H5Pget_layout(properties.get()));
  if (layout == H5D_VIRTUAL || call("H5Pget_external_count", H5Pget_external_count(properties.get())) != 0)
    fail(column.name, "stores its data in other files; a shard must contain all of its data");
  return {std::move(set), std::move(properties), layout == H5D_CHUNKED};
}

Hdf5Id Hdf5File::make_column(const Hdf5Column& column, std::uint64_t rows, Codec codec) {
  const Hdf5Call call{path_, column.name};
  const hsize_t shape[2] = {rows, column.width};
  const Hdf5Id space = call.id("H5Screate_simple", H5Screate_simple(column.dimensions(), shape, nullptr), H5Sclose);
  const hid_t properties = creation_properties(call, column, rows, codec);
  table_->table.add(column.name, shape_in_file(column, rows, codec));
  return call.id("H5Dcreate2",
                 H5Dcreate2(file_.get(), column.name.c_str(), hdf5_type(call, column), space.get(), H5P_DEFAULT,
                            properties, H5P_DEFAULT),
                 H5Dclose);
}

bool Hdf5File::has_column(const Hdf5Column& column) const {
  if (const ChunkTable* table = chunk_table()) return table->find(column.name) != nullptr;
  const Hdf5Call call{path_, column.name};
  configure_hdf5(call);
  return call("H5Lexists", H5Lexists(file_.get(), column.name.c_str(), H5P_DEFAULT)) > 0;
}

std::uint64_t Hdf5File::stored_bytes(const Hdf5Column& column) const {
  return H5Dget_storage_size(open_column(column).set.get());
}

}  // namespace gigabake
