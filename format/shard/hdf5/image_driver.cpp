#include "format/shard/hdf5/image_driver.h"

#include <hdf5.h>
#include <new>

#if H5_VERSION_GE(1, 13, 0)
#include <H5FDdevelop.h>
#endif

namespace gigabake {
namespace {

constexpr haddr_t max_address = (haddr_t(1) << 62) - 1;

/// The driver's information in the access properties.
struct ImageAccess {
  FileImage* image;
};

/// An open file of this driver. HDF5 requires that its own structure is the first member.
struct OpenImage {
  H5FD_t of_hdf5{};
  FileImage* image = nullptr;
  haddr_t end_of_addresses = 0;  ///< end of the space that HDF5 has allocated
};

OpenImage& opened(H5FD_t* file) { return *reinterpret_cast<OpenImage*>(file); }
const OpenImage& opened(const H5FD_t* file) { return *reinterpret_cast<const OpenImage*>(file); }

H5FD_t* open_image(const char*, unsigned, hid_t access, haddr_t) {
  const auto* info = static_cast<const ImageAccess*>(H5Pget_driver_info(access));
  auto* file = info == nullptr ? nullptr : new (std::nothrow) OpenImage;
  if (file == nullptr) return nullptr;
  file->image = info->image;
  return &file->of_hdf5;
}

herr_t close_image(H5FD_t* file) {
  delete &opened(file);
  return 0;
}

/// Compares files by address, so that each image is another file, whatever its name.
int compare(const H5FD_t* a, const H5FD_t* b) {
  const FileImage *first = opened(a).image, *second = opened(b).image;
  return first == second ? 0 : (first < second ? -1 : 1);
}

/// Reports the features of HDF5's driver for plain files: they determine the layout of a file.
herr_t query(const H5FD_t*, unsigned long* flags) {
  if (flags != nullptr)
    *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
             H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
  return 0;
}

haddr_t end_of_addresses(const H5FD_t* file, H5FD_mem_t) { return opened(file).end_of_addresses; }
haddr_t end_of_file(const H5FD_t* file, H5FD_mem_t) { return opened(file).image->length(); }

herr_t set_end_of_addresses(H5FD_t* file, H5FD_mem_t, haddr_t end) {
  opened(file).end_of_addresses = end;
  return 0;
}

herr_t read_image(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, std::size_t bytes, void* to) {
  opened(file).image->read(at, static_cast<std::uint8_t*>(to), bytes);
  return 0;
}

herr_t write_image(H5FD_t* file, H5FD_mem_t type, hid_t, haddr_t at, std::size_t bytes, const void* from) {
  try {
    opened(file).image->write(at, static_cast<const std::uint8_t*>(from), bytes, type == H5FD_MEM_DRAW);
    return 0;
  } catch (const std::bad_alloc&) {
    return -1;
  }
}

herr_t truncate(H5FD_t* file, hid_t, hbool_t) {
  opened(file).image->set_length(opened(file).end_of_addresses);
  return 0;
}

H5FD_class_t driver_class() {
  H5FD_class_t driver{};
#if H5_VERSION_GE(1, 13, 0)
  driver.version = H5FD_CLASS_VERSION;
  driver.value = H5FD_class_value_t(H5_VFD_RESERVED + 3);  // the range of drivers that are not registered
#endif
  driver.name = "gigabake file image";
  driver.maxaddr = max_address;
  driver.fc_degree = H5F_CLOSE_STRONG;
  driver.fapl_size = sizeof(ImageAccess);
  driver.open = open_image;
  driver.close = close_image;
  driver.cmp = compare;
  driver.query = query;
  driver.get_eoa = end_of_addresses;
  driver.set_eoa = set_end_of_addresses;
  driver.get_eof = end_of_file;
  driver.read = read_image;
  driver.write = write_image;
  driver.truncate = truncate;
  const H5FD_mem_t map[] = H5FD_FLMAP_DICHOTOMY;
  for (int type = 0; type < H5FD_MEM_NTYPES; ++type) driver.fl_map[type] = map[type];
  return driver;
}

/// Returns the identifier of the driver, which is registered once and never closed.
hid_t image_driver(const Hdf5Call& call) {
  static const H5FD_class_t driver = driver_class();
  static const hid_t id = call("H5FDregister", H5FDregister(&driver));
  return id;
}

}  // namespace

void set_image_driver(const Hdf5Call& call, std::int64_t access, FileImage& image) {
  const ImageAccess info{&image};
  call("H5Pset_driver", H5Pset_driver(access, image_driver(call), &info));
}

}  // namespace gigabake
