/// A bake's status in words.
#pragma once

#include <cstdint>
#include <string>

#include "scheduler/bake_status.h"

namespace gigabake::app {

/// 1536 as "1.5 KiB".
std::string readable_bytes(std::uint64_t bytes);
/// 12345678 as "12.3 M".
std::string readable_count(double count);
/// 3725 as "1 h 2 min", 75.2 as "1 min 15 s".
std::string readable_seconds(double seconds);

/// "12/40 cells, 1.2 M voxels/s, 3.4 MB/s, 12 s left"; during the survey "3/8 tiles surveyed, 2 s left".
std::string one_line(const BakeStatus& status);
/// How much of the phase that one_line() is about has been done, from 0 to 1.
double share_done(const BakeStatus& status);
enum class Writer {
  there,  ///< it goes on, or has said how it ended
  gone,   ///< nobody writes the status any more, though it says that the bake goes on
};

/// For people, in several lines. Control characters of names and reasons are replaced. now_s: Unix time.
std::string describe(const BakeStatus& status, double now_s, Writer writer);

}  // namespace gigabake::app
