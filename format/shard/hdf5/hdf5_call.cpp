#include "format/shard/hdf5/hdf5_call.h"

#include <algorithm>
#include <hdf5.h>
#include <string_view>
#include <type_traits>

#include "format/shard/hdf5/hdf5_types.h"
#include "lattice/error.h"

namespace gigabake {
namespace {

static_assert(std::is_same_v<hid_t, std::int64_t> && std::is_same_v<herr_t, int>);

constexpr std::string_view system_message = "error message = '";

/// Keeps what the call that failed first said, or the system's own message: the walk goes from the innermost function
/// outwards.
herr_t keep_reason(unsigned depth, const H5E_error2_t* error, void* kept) {
  auto& reason = *static_cast<std::string*>(kept);
  if (error->desc == nullptr) return 0;
  const std::string_view desc = error->desc;
  if (depth == 0 || (desc.find(system_message) != desc.npos && reason.find(system_message) == std::string::npos))
    reason = desc;
  return 0;
}

/// HDF5 puts the system's message among the call's arguments, and a line break into its time stamp.
std::string shortened(std::string reason) {
  if (const std::size_t at = reason.find(system_message); at != std::string::npos) {
    reason.erase(0, at + system_message.size());
    reason.resize(std::min(reason.find('\''), reason.size()));
  }
  std::replace(reason.begin(), reason.end(), '\n', ' ');
  return reason;
}

/// Chunks are packed and unpacked before they reach HDF5 (chunk_codec.h): nothing calls it, and it refuses.
std::size_t refuse_chunk(unsigned, std::size_t, const unsigned[], std::size_t, std::size_t*, void**) { return 0; }

/// Each time that HDF5 writes the header of a column it looks up its filters' names, and leaves an error on its stack
/// for one that it does not know. The stack has 32 places: where a shard had more columns than half of that, closing it
/// on a full disk said that a filter is missing, not that the disk is full. So it knows ours, by no name: headers have
/// the bytes that they had without.
int register_lz4(const Hdf5Call& call) {
  const H5Z_class2_t filter{H5Z_CLASS_T_VERS, lz4_filter, 1, 1, nullptr, nullptr, nullptr, refuse_chunk};
  return call("H5Zregister", H5Zregister(&filter));
}

}  // namespace

void Hdf5Call::fail(const char* name) const {
  std::string reason;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_reason, &reason);
  throw InputError(file, object, std::string(name) + " failed" + (reason.empty() ? "" : ": " + shortened(reason)));
}

/// HDF5 would also load a filter that we do not call, only to store the comment in it: then the same shard had other
/// bytes on another machine. And at the program's end it would flush, and crash over, a file that a full disk kept it
/// from closing; we close every file ourselves. And a shard has its data in itself: where a link leads into another
/// file, nothing follows it.
void calm_hdf5(const Hdf5Call& call) {
  static const herr_t once [[maybe_unused]] = H5dont_atexit();  // the second time it leaves an error on the stack
  call("H5Eset_auto2", H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr));
  call("H5PLset_loading_state", H5PLset_loading_state(0));
  // Once for the process: two threads that look and then unregister would get into each other's way.
  static const int external_links [[maybe_unused]] = call("H5Lunregister", H5Lunregister(H5L_TYPE_EXTERNAL));
  static const int lz4 [[maybe_unused]] = register_lz4(call);
}

}  // namespace gigabake
