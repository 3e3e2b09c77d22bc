#include "format/hdf5_call.h"

#include <algorithm>
#include <hdf5.h>
#include <type_traits>

#include "format/error.h"

namespace gigabake {
namespace {

static_assert(std::is_same_v<hid_t, std::int64_t> && std::is_same_v<herr_t, int>);

/// Keeps what the call that failed first said: the walk goes from the innermost function outwards.
herr_t keep_innermost(unsigned depth, const H5E_error2_t* error, void* reason) {
  if (depth == 0 && error->desc != nullptr) *static_cast<std::string*>(reason) = error->desc;
  return 0;
}

/// HDF5 puts the system's message among the call's arguments, and a line break into its time stamp.
std::string shortened(std::string reason) {
  const std::string_view key = "error message = '";
  if (const std::size_t at = reason.find(key); at != std::string::npos) {
    reason.erase(0, at + key.size());
    reason.resize(std::min(reason.find('\''), reason.size()));
  }
  std::replace(reason.begin(), reason.end(), '\n', ' ');
  return reason;
}

}  // namespace

void Hdf5Call::fail(const char* name) const {
  std::string reason;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_innermost, &reason);
  throw InputError(file, object, std::string(name) + " failed" + (reason.empty() ? "" : ": " + shortened(reason)));
}

/// HDF5 would also load a filter that we do not call, only to store the comment in it: then the same shard had other
/// bytes on another machine. And at the program's end it would flush, and crash over, a file that a full disk kept it
/// from closing; we close every file ourselves.
void calm_hdf5(const Hdf5Call& call) {
  static const herr_t once [[maybe_unused]] = H5dont_atexit();  // the second time it leaves an error on the stack
  call("H5Eset_auto2", H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr));
  call("H5PLset_loading_state", H5PLset_loading_state(0));
}

}  // namespace gigabake
