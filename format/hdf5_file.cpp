#include "format/hdf5_file.h"

#include <algorithm>

#include "format/chunk_codec.h"
#include "format/error.h"
#include "format/parallel.h"

namespace gigabake {
namespace {

constexpr H5Z_filter_t lz4_filter = 32004;
constexpr std::size_t chunk_bytes = 128 << 10, most_chunks = 1024, chunks_in_hand = 64;
constexpr std::size_t largest_text = 64 << 10;

/// HDF5 prints its error stack by itself unless told not to.
void silence_hdf5() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

/// Object headers and chunk indexes with checksums of their own.
Hdf5Id newest_format() {
  Hdf5Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_V110);
  H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG);
  return access;
}

std::size_t rows_per_chunk(std::size_t rows, std::size_t row_bytes) {
  const std::size_t wanted = std::max(chunk_bytes / row_bytes, (rows + most_chunks - 1) / most_chunks);
  return std::clamp<std::size_t>(wanted, 1, rows);
}

Hdf5Id creation_properties(std::size_t rows, const Hdf5Column& column) {
  Hdf5Id create(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(create.get(), false);
  if (rows == 0) return create;
  const hsize_t chunk[2] = {rows_per_chunk(rows, column.width * column.element_bytes), column.width};
  H5Pset_chunk(create.get(), column.width == 1 ? 1 : 2, chunk);
  H5Pset_filter(create.get(), lz4_filter, H5Z_FLAG_OPTIONAL, 0, nullptr);
  H5Pset_fletcher32(create.get());
  return create;
}

/// Chunk `index` of the data, zeros after its end: stored chunks are always whole.
std::vector<std::uint8_t> encode_rows(const std::uint8_t* data, std::size_t bytes, std::size_t whole_bytes,
                                      std::size_t index) {
  const std::size_t at = index * whole_bytes, here = std::min(whole_bytes, bytes - at);
  if (here == whole_bytes) return encode_chunk({data + at, here});
  std::vector<std::uint8_t> padded(whole_bytes, 0);
  std::copy_n(data + at, here, padded.begin());
  return encode_chunk(padded);
}

}  // namespace

Hdf5File::Hdf5File(std::filesystem::path path, Hdf5Id file) : path_(std::move(path)), file_(std::move(file)) {
  if (file_.get() < 0) fail("", "cannot be opened as an HDF5 file");
}

Hdf5File Hdf5File::create(const std::filesystem::path& path) {
  silence_hdf5();
  const Hdf5Id access = newest_format();
  const Hdf5Id properties(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  return {path, Hdf5Id(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, properties.get(), access.get()), H5Fclose)};
}

Hdf5File Hdf5File::open(const std::filesystem::path& path) {
  silence_hdf5();
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) throw InputError(path, "", "no such file; bake the scene again");
  const Hdf5Id access = newest_format();
  return {path, Hdf5Id(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose)};
}

void Hdf5File::fail(const std::string& object, const std::string& message) const {
  throw InputError(path_, object, message);
}

void Hdf5File::make_group(const std::string& name) {
  const Hdf5Id properties(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties.get(), false);
  const Hdf5Id group(H5Gcreate2(file_.get(), name.c_str(), H5P_DEFAULT, properties.get(), H5P_DEFAULT), H5Gclose);
  if (group.get() < 0) fail(name, "cannot write (disk full?)");
}

void Hdf5File::write_column(const Hdf5Column& column, const void* data, std::size_t rows, int threads) {
  const hsize_t shape[2] = {rows, column.width};
  const Hdf5Id space(H5Screate_simple(column.width == 1 ? 1 : 2, shape, nullptr), H5Sclose);
  const Hdf5Id properties = creation_properties(rows, column);
  const Hdf5Id set(H5Dcreate2(file_.get(), column.name.c_str(), column.type, space.get(), H5P_DEFAULT, properties.get(),
                              H5P_DEFAULT),
                   H5Dclose);
  if (set.get() < 0) fail(column.name, "cannot write (disk full?)");
  if (rows == 0) return;
  const std::size_t row_bytes = column.width * column.element_bytes, per_chunk = rows_per_chunk(rows, row_bytes);
  const std::size_t chunks = (rows + per_chunk - 1) / per_chunk;
  for (std::size_t first = 0; first < chunks; first += chunks_in_hand) {
    std::vector<std::vector<std::uint8_t>> encoded(std::min(chunks_in_hand, chunks - first));
    parallel_ranges(encoded.size(), 1, threads, [&](std::size_t i, std::size_t) {
      encoded[i] =
          encode_rows(static_cast<const std::uint8_t*>(data), rows * row_bytes, per_chunk * row_bytes, first + i);
    });
    for (std::size_t i = 0; i < encoded.size(); ++i) {
      const hsize_t offset[2] = {(first + i) * per_chunk, 0};
      if (H5Dwrite_chunk(set.get(), H5P_DEFAULT, 0, offset, encoded[i].size(), encoded[i].data()) < 0)
        fail(column.name, "cannot write (disk full?)");
    }
  }
}

std::size_t Hdf5File::column_rows(const Hdf5Column& column) const {
  const Hdf5Id set(H5Dopen2(file_.get(), column.name.c_str(), H5P_DEFAULT), H5Dclose);
  if (set.get() < 0) fail(column.name, "is missing or damaged");
  const Hdf5Id space(H5Dget_space(set.get()), H5Sclose), type(H5Dget_type(set.get()), H5Tclose);
  hsize_t shape[2] = {0, 1};
  const int rank = H5Sget_simple_extent_ndims(space.get());
  if (rank != (column.width == 1 ? 1 : 2) || H5Sget_simple_extent_dims(space.get(), shape, nullptr) < 0 ||
      shape[1] != column.width)
    fail(column.name, "has another shape than expected");
  if (H5Tequal(type.get(), column.type) <= 0) fail(column.name, "has another type than expected");
  // A damaged shape must not make us allocate: LZ4 packs at most 255:1.
  const std::uint64_t file_bytes = std::filesystem::file_size(path_);
  if (shape[0] > (file_bytes * 256 + (1 << 20)) / (column.width * column.element_bytes))
    fail(column.name, "is larger than its file can hold");
  return shape[0];
}

void Hdf5File::read_column(const Hdf5Column& column, void* data, std::size_t rows) const {
  if (rows == 0) return;
  const Hdf5Id set(H5Dopen2(file_.get(), column.name.c_str(), H5P_DEFAULT), H5Dclose);
  const Hdf5Id properties(H5Dget_create_plist(set.get()), H5Pclose);
  hsize_t chunk[2] = {0, column.width};
  const int rank = column.width == 1 ? 1 : 2;
  const std::size_t row_bytes = column.width * column.element_bytes;
  if (H5Pget_layout(properties.get()) != H5D_CHUNKED || H5Pget_chunk(properties.get(), rank, chunk) != rank ||
      chunk[0] == 0 || chunk[0] > rows || chunk[1] != column.width)
    fail(column.name, "is not stored in the chunks that were expected");
  std::vector<std::uint8_t> stored, raw(chunk[0] * row_bytes);
  auto* to = static_cast<std::uint8_t*>(data);
  for (std::size_t row = 0; row < rows; row += chunk[0]) {
    const hsize_t offset[2] = {row, 0};
    hsize_t bytes = 0;
    if (H5Dget_chunk_storage_size(set.get(), offset, &bytes) < 0 || bytes == 0 ||
        bytes > raw.size() + raw.size() / 8 + 4096)
      fail(column.name, "row " + std::to_string(row) + ": the chunk is missing or damaged");
    stored.resize(bytes);
    std::uint32_t skipped_filters = 0;
    if (H5Dread_chunk(set.get(), H5P_DEFAULT, offset, &skipped_filters, stored.data()) < 0 || skipped_filters != 0 ||
        !decode_chunk(stored, raw))
      fail(column.name,
           "row " + std::to_string(row) + ": the checksum is wrong; the file is damaged, bake the cell again");
    std::copy_n(raw.begin(), std::min<std::size_t>(chunk[0], rows - row) * row_bytes, to + row * row_bytes);
  }
}

void Hdf5File::write_attribute(const char* name, hid_t type, const void* data, std::size_t count) {
  const hsize_t size = count;
  const Hdf5Id space(count == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &size, nullptr), H5Sclose);
  const Hdf5Id attribute(H5Acreate2(file_.get(), name, type, space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  if (attribute.get() < 0 || H5Awrite(attribute.get(), type, data) < 0) fail(name, "cannot write (disk full?)");
}

void Hdf5File::write_attribute(const char* name, const std::string& text) {
  const Hdf5Id type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), std::max<std::size_t>(1, text.size()));
  H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
  const std::string padded = text.empty() ? std::string(1, '\0') : text;
  write_attribute(name, type.get(), padded.data(), 0);
}

bool Hdf5File::has_attribute(const char* name) const { return H5Aexists(file_.get(), name) > 0; }

void Hdf5File::read_attribute(const char* name, hid_t type, void* data, std::size_t count) const {
  const Hdf5Id attribute(H5Aopen(file_.get(), name, H5P_DEFAULT), H5Aclose);
  if (attribute.get() < 0) fail(name, "is missing; not a gigabake shard?");
  const Hdf5Id space(H5Aget_space(attribute.get()), H5Sclose), stored(H5Aget_type(attribute.get()), H5Tclose);
  const hssize_t elements = H5Sget_simple_extent_npoints(space.get());
  if (elements != hssize_t(std::max<std::size_t>(1, count)) || H5Tequal(stored.get(), type) <= 0)
    fail(name, "has another type or size than expected");
  if (H5Aread(attribute.get(), type, data) < 0) fail(name, "cannot be read");
}

std::string Hdf5File::read_text(const char* name) const {
  const Hdf5Id attribute(H5Aopen(file_.get(), name, H5P_DEFAULT), H5Aclose);
  if (attribute.get() < 0) fail(name, "is missing; not a gigabake shard?");
  const Hdf5Id space(H5Aget_space(attribute.get()), H5Sclose), type(H5Aget_type(attribute.get()), H5Tclose);
  const std::size_t size = H5Tget_size(type.get());
  if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) != 0 || size > largest_text ||
      H5Sget_simple_extent_npoints(space.get()) != 1)
    fail(name, "is not a fixed-length text");
  std::string text(size, '\0');
  if (H5Aread(attribute.get(), type.get(), text.data()) < 0) fail(name, "cannot be read");
  text.resize(std::min(text.find('\0'), text.size()));
  return text;
}

void Hdf5File::close() {
  if (!file_.close()) fail("", "cannot write (disk full?)");
}

}  // namespace gigabake
