#include "format/shard/hdf5/hdf5_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <hdf5.h>
#include <map>
#include <sys/stat.h>
#include <utility>

#include "core/base/error.h"
#include "format/shard/hdf5/hdf5_types.h"
#include "format/shard/hdf5/image_driver.h"

namespace gigabake {
namespace {

constexpr std::size_t max_text = 64 << 10;

/// Makes the access properties of all files. Selects the format of HDF5 1.10, which has checksums in object headers
/// and chunk indexes. Disables file locks, because many cluster file systems lack them. Published files never change,
/// so they need no locks. Disables HDF5's cache of unpacked chunks: chunks are read and written in stored form, so the
/// cache would only take memory.
hid_t made_access_properties(const Hdf5Call& call) {
  const hid_t access = call("H5Pcreate", H5Pcreate(H5P_FILE_ACCESS));
  call("H5Pset_libver_bounds", H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110));
  call("H5Pset_fapl_sec2", H5Pset_fapl_sec2(access));  // the handle of a plain file is its descriptor
  call("H5Pset_fclose_degree", H5Pset_fclose_degree(access, H5F_CLOSE_STRONG));
  call("H5Pset_file_locking", H5Pset_file_locking(access, false, true));
  call("H5Pset_cache", H5Pset_cache(access, 0, 0, 0, 1));
  return access;
}

/// Returns properties that all files on disk share. They are never closed.
hid_t access_properties(const Hdf5Call& call) {
  static const hid_t access = made_access_properties(call);
  return access;
}

}  // namespace

std::int64_t hdf5_type(Hdf5Type type) {
  switch (type) {
    case Hdf5Type::u8:
      return H5T_STD_U8LE;
    case Hdf5Type::i8:
      return H5T_STD_I8LE;
    case Hdf5Type::u16:
      return H5T_STD_U16LE;
    case Hdf5Type::u32:
      return H5T_STD_U32LE;
    case Hdf5Type::i32:
      return H5T_STD_I32LE;
    case Hdf5Type::u64:
      return H5T_STD_U64LE;
    case Hdf5Type::i64:
      return H5T_STD_I64LE;
    case Hdf5Type::f64:
      break;
  }
  return H5T_IEEE_F64LE;
}

std::int64_t hdf5_type(const Hdf5Call& call, const Hdf5Column& column) {
  const std::int64_t element = hdf5_type(column.type);
  if (column.planes != BytePlanes::of_rows) return element;
  static std::map<std::pair<Hdf5Type, hsize_t>, hid_t> arrays;  // guarded by the turn of `call`
  const hsize_t width = column.width;
  hid_t& array = arrays[{column.type, width}];
  if (array == 0) array = call("H5Tarray_create2", H5Tarray_create2(element, 1, &width));
  return array;
}

std::size_t element_bytes(Hdf5Type type) {
  switch (type) {
    case Hdf5Type::u8:
    case Hdf5Type::i8:
      return 1;
    case Hdf5Type::u16:
      return 2;
    case Hdf5Type::u32:
    case Hdf5Type::i32:
      return 4;
    default:
      return 8;
  }
}

Hdf5File::Hdf5File(std::filesystem::path path, Hdf5Id file) : path_(std::move(path)), file_(std::move(file)) {}

namespace {

/// Makes creation properties of objects without time stamps.
hid_t untimed_properties(const Hdf5Call& call, hid_t of) {
  const hid_t properties = call("H5Pcreate", H5Pcreate(of));
  call("H5Pset_obj_track_times", H5Pset_obj_track_times(properties, false));
  return properties;
}

/// Makes the creation properties of all files. A root group with few attributes would store more than eight of them in
/// a heap with an index, which take longer to write and to read than the object header.
hid_t made_file_properties(const Hdf5Call& call) {
  constexpr unsigned max_in_header = 64, min_in_heap = 60;
  const hid_t properties = untimed_properties(call, H5P_FILE_CREATE);
  call("H5Pset_attr_phase_change", H5Pset_attr_phase_change(properties, max_in_header, min_in_heap));
  return properties;
}

Hdf5Id created(const Hdf5Call& call, const std::filesystem::path& path, hid_t access) {
  static const hid_t properties = made_file_properties(call);
  return call.id("H5Fcreate", H5Fcreate(path.c_str(), H5F_ACC_TRUNC, properties, access), H5Fclose);
}

}  // namespace

Hdf5File Hdf5File::create(const std::filesystem::path& path, const std::filesystem::path& called) {
  const Hdf5Call call{called, ""};
  configure_hdf5(call);
  count_work(WorkCounter::files_opened);
  return {called, created(call, path, access_properties(call))};
}

Hdf5File Hdf5File::create(FileImage& image, const std::filesystem::path& called) {
  const Hdf5Call call{called, ""};
  configure_hdf5(call);
  image.begin_file();
  static const hid_t access = made_access_properties(call);
  set_image_driver(call, access, image);
  Hdf5File file(called, created(call, called, access));
  file.image_ = &image;
  return file;
}

Hdf5File Hdf5File::open(const std::filesystem::path& path, ChunkPlaces places, std::shared_ptr<ChunkCache> chunks) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) throw InputError(path, "", "no such file; bake the scene again");
  const Hdf5Call call{path, ""};
  configure_hdf5(call);
  count_work(WorkCounter::files_opened);
  Hdf5File file(path, call.id("H5Fopen", H5Fopen(path.c_str(), H5F_ACC_RDONLY, access_properties(call)), H5Fclose));
  void* handle = nullptr;
  call("H5Fget_vfd_handle", H5Fget_vfd_handle(file.file_.get(), H5P_DEFAULT, &handle));
  file.descriptor_ = Descriptor::duplicate(*static_cast<const int*>(handle));
  struct stat status {};
  if (!file.descriptor_.is_open() || ::fstat(file.descriptor(), &status) != 0)
    file.fail("", std::string("cannot be opened: ") + std::strerror(errno));
  file.bytes_ = std::uint64_t(status.st_size);
  file.chunks_ = std::move(chunks);
  file.table_->is_read = places == ChunkPlaces::by_index;
  return file;
}

void Hdf5File::fail(const std::string& object, const std::string& message) const {
  throw InputError(path_, object, message);
}

void Hdf5File::make_group(const std::string& name) {
  const Hdf5Call call{path_, name};
  static const hid_t properties = untimed_properties(call, H5P_GROUP_CREATE);
  const Hdf5Id group =
      call.id("H5Gcreate2", H5Gcreate2(file_.get(), name.c_str(), H5P_DEFAULT, properties, H5P_DEFAULT), H5Gclose);
}

void Hdf5File::write_raw_attribute(const char* name, std::int64_t type, const void* data, std::size_t count) {
  const Hdf5Call call{path_, name};
  static const hid_t scalar = call("H5Screate", H5Screate(H5S_SCALAR)), row = call("H5Screate", H5Screate(H5S_SIMPLE));
  const hsize_t size = count;
  if (count != 0) call("H5Sset_extent_simple", H5Sset_extent_simple(row, 1, &size, nullptr));
  const Hdf5Id attribute = call.id(
      "H5Acreate2", H5Acreate2(file_.get(), name, type, count == 0 ? scalar : row, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  call("H5Awrite", H5Awrite(attribute.get(), type, data));
}

void Hdf5File::write_attribute(const char* name, Hdf5Type type, const void* data, std::size_t count) {
  write_raw_attribute(name, hdf5_type(type), data, count);
}

void Hdf5File::write_attribute(const char* name, const std::string& text) {
  const Hdf5Call call{path_, name};
  const Hdf5Id type = call.id("H5Tcopy", H5Tcopy(H5T_C_S1), H5Tclose);
  call("H5Tset_size", H5Tset_size(type.get(), std::max<std::size_t>(1, text.size())));
  call("H5Tset_strpad", H5Tset_strpad(type.get(), H5T_STR_NULLPAD));
  const std::string padded = text.empty() ? std::string(1, '\0') : text;
  write_raw_attribute(name, type.get(), padded.data(), 0);
}

bool Hdf5File::has_attribute(const char* name) const {
  return Hdf5Call{path_, name}("H5Aexists", H5Aexists(file_.get(), name)) > 0;
}

void Hdf5File::read_attribute(const char* name, Hdf5Type type, void* data, std::size_t count) const {
  if (!has_attribute(name)) fail(name, "is missing; not a gigabake shard?");
  const Hdf5Call call{path_, name};
  const Hdf5Id attribute = call.id("H5Aopen", H5Aopen(file_.get(), name, H5P_DEFAULT), H5Aclose);
  const Hdf5Id space = call.id("H5Aget_space", H5Aget_space(attribute.get()), H5Sclose);
  const Hdf5Id stored = call.id("H5Aget_type", H5Aget_type(attribute.get()), H5Tclose);
  const hssize_t elements = call("H5Sget_simple_extent_npoints", H5Sget_simple_extent_npoints(space.get()));
  if (elements != hssize_t(std::max<std::size_t>(1, count)) ||
      call("H5Tequal", H5Tequal(stored.get(), hdf5_type(type))) == 0)
    fail(name, "has another type or size than expected");
  call("H5Aread", H5Aread(attribute.get(), hdf5_type(type), data));
}

std::string Hdf5File::read_text(const char* name) const {
  if (!has_attribute(name)) fail(name, "is missing; not a gigabake shard?");
  const Hdf5Call call{path_, name};
  const Hdf5Id attribute = call.id("H5Aopen", H5Aopen(file_.get(), name, H5P_DEFAULT), H5Aclose);
  const Hdf5Id space = call.id("H5Aget_space", H5Aget_space(attribute.get()), H5Sclose);
  const Hdf5Id type = call.id("H5Aget_type", H5Aget_type(attribute.get()), H5Tclose);
  const std::size_t size = H5Tget_size(type.get());
  if (call("H5Tget_class", H5Tget_class(type.get())) != H5T_STRING || size == 0 || size > max_text ||
      call("H5Tis_variable_str", H5Tis_variable_str(type.get())) != 0 ||
      call("H5Sget_simple_extent_npoints", H5Sget_simple_extent_npoints(space.get())) != 1)
    fail(name, "is not a fixed-length text");
  std::string text(size, '\0');
  call("H5Aread", H5Aread(attribute.get(), type.get(), text.data()));
  text.resize(std::min(text.find('\0'), text.size()));
  return text;
}

void Hdf5File::close() { Hdf5Call{path_, ""}("H5Fclose", file_.close()); }

}  // namespace gigabake
