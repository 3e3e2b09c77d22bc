#include "format/shard/hdf5/hdf5_call.h"

#include <algorithm>
#include <hdf5.h>
#include <string_view>
#include <type_traits>

#include "core/base/error.h"
#include "format/shard/hdf5/hdf5_types.h"

namespace gigabake {
namespace {

static_assert(std::is_same_v<hid_t, std::int64_t> && std::is_same_v<herr_t, int>);

constexpr std::string_view system_message = "error message = '";

/// Keeps the description of the innermost function that failed. The first description with a system message replaces
/// it. HDF5 calls keep_reason() once per failed function, from the innermost function outwards.
herr_t keep_reason(unsigned depth, const H5E_error2_t* error, void* kept) {
  auto& reason = *static_cast<std::string*>(kept);
  if (error->desc == nullptr) return 0;
  const std::string_view desc = error->desc;
  if (depth == 0 || (desc.find(system_message) != desc.npos && reason.find(system_message) == std::string::npos))
    reason = desc;
  return 0;
}

/// Reduces `reason` to the system message, if it contains a system message. Replaces line breaks, which HDF5's time
/// stamp contains, by spaces.
std::string shortened(std::string reason) {
  if (const std::size_t at = reason.find(system_message); at != std::string::npos) {
    reason.erase(0, at + system_message.size());
    reason.resize(std::min(reason.find('\''), reason.size()));
  }
  std::replace(reason.begin(), reason.end(), '\n', ' ');
  return reason;
}

/// Rejects the call. Chunks are packed and unpacked outside of HDF5 (chunk_codec.h), so HDF5 must never call this
/// filter.
std::size_t refuse_chunk(unsigned, std::size_t, const unsigned[], std::size_t, std::size_t*, void**) { return 0; }

/// Registers the LZ4 filter. When HDF5 writes a column's header, it looks up the names of the filters and leaves an
/// error on its error stack for each unknown filter. The error stack has 32 entries. Closing a shard of more than 16
/// columns on a full disk would therefore report a missing filter instead of the full disk. The filter is registered
/// without a name, so headers keep the same bytes.
int register_lz4(const Hdf5Call& call) {
  const H5Z_class2_t filter{H5Z_CLASS_T_VERS, lz4_filter, 1, 1, nullptr, nullptr, nullptr, refuse_chunk};
  return call("H5Zregister", H5Zregister(&filter));
}

}  // namespace

std::recursive_mutex& Hdf5Turn::mutex() {
  static std::recursive_mutex turns;
  return turns;
}

void Hdf5Call::fail(const char* name) const {
  std::string reason;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_reason, &reason);
  throw InputError(file, object, std::string(name) + " failed" + (reason.empty() ? "" : ": " + shortened(reason)));
}

/// Disables plugin lookup, the flush at exit and external links.
/// HDF5 would store a plugin's comment in the file, so the file's bytes would depend on the installed plugins. The
/// flush at exit crashes on a file that could not be closed because of a full disk. It is not needed, because gigabake
/// closes every file itself. A shard must contain all its data, so links to other files are not followed.
void configure_hdf5(const Hdf5Call& call) {
  thread_local bool is_configured = false;
  if (is_configured) return;
  static const herr_t once [[maybe_unused]] = H5dont_atexit();  // a second call would leave an error on the error stack
  call("H5Eset_auto2", H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr));
  static const herr_t no_plugins [[maybe_unused]] = call("H5PLset_loading_state", H5PLset_loading_state(0));
  // Runs once per process, because a second H5Lunregister() would fail. A look-up before each call would race with
  // other threads.
  static const int external_links [[maybe_unused]] = call("H5Lunregister", H5Lunregister(H5L_TYPE_EXTERNAL));
  static const int lz4 [[maybe_unused]] = register_lz4(call);
  is_configured = true;
}

}  // namespace gigabake
