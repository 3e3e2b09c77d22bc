/// A bake's status as text.
#pragma once

#include <cstdint>
#include <string>

#include "scheduler/status/bake_status.h"

namespace gigabake::app {

/// Formats 1536 as "1.5 KiB".
std::string readable_bytes(std::uint64_t bytes);
/// Formats 12345678 as "12.3 M".
std::string readable_count(double count);
/// Formats 3725 as "1 h 2 min", 75.2 as "1 min 15 s".
std::string readable_seconds(double seconds);

/// Returns "12/40 cells, 1.2 M voxels/s, 3.4 MB/s, 12 s left"; during the scan `3/8 tiles scanned, 2 s left`.
std::string one_line(const BakeStatus& status);
/// Returns the completed fraction of the phase that one_line() describes, from 0 to 1.
double share_done(const BakeStatus& status);
enum class Writer {
  there,  ///< the bake is running, or has recorded its end
  gone,   ///< the bake has not recorded its end, but no process updates its status
};

/// Returns several lines for people. Replaces control characters of names and reasons. `now_s` is the Unix time in
/// seconds.
std::string describe(const BakeStatus& status, double now_s, Writer writer);

}  // namespace gigabake::app
