/// The few things that shards need of HDF5, with owned handles and every call checked.
#pragma once

#include <cstdint>
#include <filesystem>
#include <hdf5.h>
#include <string>
#include <utility>
#include <vector>

namespace gigabake {

/// Owns an HDF5 identifier.
class Hdf5Id {
 public:
  Hdf5Id(hid_t id, herr_t (*closer)(hid_t)) : id_(id), close_(closer) {}
  Hdf5Id(Hdf5Id&& o) noexcept : id_(std::exchange(o.id_, -1)), close_(o.close_) {}
  Hdf5Id& operator=(Hdf5Id&&) = delete;
  ~Hdf5Id() {
    if (id_ >= 0) close_(id_);
  }
  hid_t get() const { return id_; }
  /// Closes now. Errors  false: data could not be flushed.
  bool close() { return close_(std::exchange(id_, -1)) >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// One array of fixed-width rows. Host byte order is little endian, as in the file.
struct Hdf5Column {
  std::string name;   ///< "/lod_0/mask"
  hid_t type;         ///< of one element: H5T_STD_U64LE, …
  std::size_t width;  ///< elements a row; 1: the dataset has one dimension
  std::size_t element_bytes;
};

/// Errors  All members throw InputError: file, object, what failed.
class Hdf5File {
 public:
  static Hdf5File create(const std::filesystem::path& path);
  static Hdf5File open(const std::filesystem::path& path);

  void make_group(const std::string& name);
  /// Chunked, each chunk as chunk_codec.h, compressed by `threads`.
  void write_column(const Hdf5Column& column, const void* data, std::size_t rows, int threads);
  /// Rows of the dataset, after its shape and type were compared with `column`.
  std::size_t column_rows(const Hdf5Column& column) const;
  /// data: room for column_rows() rows.
  void read_column(const Hdf5Column& column, void* data, std::size_t rows) const;

  void write_attribute(const char* name, hid_t type, const void* data, std::size_t count);  ///< count 0: a scalar
  void write_attribute(const char* name, const std::string& text);
  bool has_attribute(const char* name) const;
  /// Exactly `count` elements (0: a scalar) of class and size of `type`.
  void read_attribute(const char* name, hid_t type, void* data, std::size_t count) const;
  std::string read_text(const char* name) const;  ///< a fixed-length string of at most 64 KiB

  void close();
  [[noreturn]] void fail(const std::string& object, const std::string& message) const;

 private:
  Hdf5File(std::filesystem::path path, Hdf5Id file);

  std::filesystem::path path_;
  Hdf5Id file_;
};

}  // namespace gigabake
