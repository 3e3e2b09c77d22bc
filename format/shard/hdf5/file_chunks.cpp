#include "format/shard/hdf5/file_chunks.h"

#include <hdf5.h>

#include "core/base/error.h"
#include "format/shard/hdf5/hdf5_call.h"
#include "format/shard/hdf5/hdf5_types.h"
#include "format/shard/shard_layout.h"

namespace gigabake {
namespace {

herr_t add_name(hid_t, const char* name, const H5L_info_t*, void* names) {
  static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}

/// Size in bytes of a chunk (0 if the column has no chunks) and of an element.
struct ChunkShape {
  std::size_t bytes = 0, element_bytes = 1;
};

ChunkShape shape_of(const Hdf5Call& call, const Hdf5Id& set, const Hdf5Id& properties) {
  if (call("H5Pget_layout", H5Pget_layout(properties.get())) != H5D_CHUNKED) return {};
  const Hdf5Id type = call.id("H5Dget_type", H5Dget_type(set.get()), H5Tclose);
  ChunkShape shape{H5Tget_size(type.get()), H5Tget_size(type.get())};
  hsize_t rows[2] = {1, 1};
  const int dimensions = call("H5Pget_chunk", H5Pget_chunk(properties.get(), 2, rows));
  for (int d = 0; d < std::min(dimensions, 2); ++d) shape.bytes *= rows[d];
  return shape;
}

/// Returns the filters of the dataset. Ignores filters that a shard cannot have; they cause an InputError when a chunk
/// is unpacked.
ChunkFilters filters_of(const Hdf5Call& call, const Hdf5Id& properties, std::size_t element_bytes) {
  ChunkFilters filters;
  const int count = call("H5Pget_nfilters", H5Pget_nfilters(properties.get()));
  for (int i = 0; i < count; ++i) {
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    const H5Z_filter_t filter = call(
        "H5Pget_filter2", H5Pget_filter2(properties.get(), unsigned(i), &flags, &values, nullptr, 0, nullptr, &config));
    if (filter == H5Z_FILTER_DEFLATE) filters.codec = Codec::deflate;
    if (filter == H5Z_FILTER_SHUFFLE) filters.shuffled_bytes = element_bytes;
  }
  return filters;
}

/// Returns the length of matches with which the writer packs a column, named like "lod_0/rgb".
std::uint32_t min_match_bytes_of(const std::string& name) {
  for (std::size_t c = 0; c < level_column_count && name.starts_with("lod_"); ++c)
    if (const Hdf5Column column = level_column(0, LevelColumn(c)); column.name.ends_with(name.substr(name.find('/'))))
      return column.min_match_bytes;
  return deflate::min_match;
}

void add_chunks(const std::filesystem::path& path, const Hdf5Id& file, const std::string& name,
                std::vector<FileChunk>& chunks) {
  const Hdf5Call call{path, name};
  const Hdf5Id object = call.id("H5Oopen", H5Oopen(file.get(), name.c_str(), H5P_DEFAULT), H5Oclose);
  if (H5Iget_type(object.get()) != H5I_DATASET) return;
  const Hdf5Id properties = call.id("H5Dget_create_plist", H5Dget_create_plist(object.get()), H5Pclose);
  const ChunkShape shape = shape_of(call, object, properties);
  if (shape.bytes == 0) return;
  ChunkFilters filters = filters_of(call, properties, shape.element_bytes);
  filters.min_match_bytes = min_match_bytes_of(name);
  const Hdf5Id space = call.id("H5Dget_space", H5Dget_space(object.get()), H5Sclose);
  hsize_t count = 0;
  call("H5Dget_num_chunks", H5Dget_num_chunks(object.get(), space.get(), &count));
  for (hsize_t i = 0; i < count; ++i) {
    hsize_t offset[2] = {}, bytes = 0;
    unsigned skipped = 0;
    haddr_t address = 0;
    call("H5Dget_chunk_info", H5Dget_chunk_info(object.get(), space.get(), i, offset, &skipped, &address, &bytes));
    std::vector<std::uint8_t> stored(bytes);
    std::uint32_t mask = 0;
    call("H5Dread_chunk", H5Dread_chunk(object.get(), H5P_DEFAULT, offset, &mask, stored.data()));
    FileChunk chunk{name.substr(name.rfind('/') + 1), filters, std::vector<std::uint8_t>(shape.bytes)};
    if (!decode_chunk(stored, filters, shape.bytes, chunk.raw))
      throw InputError(path, name, "a chunk is damaged", std::nullopt);
    chunks.push_back(std::move(chunk));
  }
}

}  // namespace

std::vector<FileChunk> file_chunks(const std::filesystem::path& path) {
  const Hdf5Call call{path, ""};
  configure_hdf5(call);
  const Hdf5Id file = call.id("H5Fopen", H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  std::vector<std::string> names;
  call("H5Lvisit", H5Lvisit(file.get(), H5_INDEX_NAME, H5_ITER_INC, add_name, &names));
  std::vector<FileChunk> chunks;
  for (const std::string& name : names) add_chunks(path, file, name, chunks);
  return chunks;
}

}  // namespace gigabake
