/// HDF5 identifiers that close themselves, and calls whose failure names the file, the object and the call. This header
/// does not include <hdf5.h>. HDF5 guarantees that identifiers are 64-bit, and that failed calls return negative
/// values.
#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <string>
#include <utility>

namespace gigabake {

using Hdf5Closer = int (*)(std::int64_t id);

/// A turn at HDF5: other threads wait until it ends. A thread may hold several turns at once. HDF5 locks each of its
/// calls, and a blocked thread sleeps until it is woken. Sequences of calls by several threads would interleave call by
/// call, which takes several times as long as one sequence after the other. A turn must not wait for other threads.
class Hdf5Turn {
 public:
  Hdf5Turn() : lock_(mutex()) {}

 private:
  static std::recursive_mutex& mutex();
  std::unique_lock<std::recursive_mutex> lock_;
};

/// An owner of an HDF5 identifier.
class Hdf5Id {
 public:
  Hdf5Id(std::int64_t id, Hdf5Closer closer) : id_(id), close_(closer) {}
  Hdf5Id(Hdf5Id&& o) noexcept : id_(std::exchange(o.id_, -1)), close_(o.close_) {}
  Hdf5Id& operator=(Hdf5Id&&) = delete;
  ~Hdf5Id() {
    if (id_ >= 0) close();
  }
  std::int64_t get() const { return id_; }
  /// Closes the identifier now. Returns HDF5's result: negative if data could not be flushed.
  int close() {
    const Hdf5Turn turn;
    return close_(std::exchange(id_, -1));
  }

 private:
  std::int64_t id_;
  Hdf5Closer close_;
};

/// Wrapper of calls on one object of one file: `call("H5Pset_chunk", H5Pset_chunk(…))` returns the call's result. Holds
/// a turn at HDF5.
/// Errors  InputError naming file, object, call and HDF5's innermost reason, if the call failed.
struct Hdf5Call {
  const std::filesystem::path& file;
  std::string object;
  Hdf5Turn turn{};

  template <class Result>
  Result operator()(const char* name, Result result) const {
    if (result < 0) fail(name);
    return result;
  }
  Hdf5Id id(const char* name, std::int64_t result, Hdf5Closer closer) const {
    return {operator()(name, result), closer};
  }
  [[noreturn]] void fail(const char* name) const;
};

/// Disables HDF5's own printing of errors and configures the library. HDF5 keeps the printing setting per thread, so
/// each thread must call configure_hdf5() before any other HDF5 call.
void configure_hdf5(const Hdf5Call& call);

}  // namespace gigabake
