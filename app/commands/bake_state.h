/// The state of a bake, read from its folder.
#pragma once

#include <string>

#include "scheduler/status/bake_status.h"

namespace gigabake::app {

struct Seen {
  BakeStatus status;
  double now_s = 0;
  bool interrupted = false;  ///< the bake has not recorded its end, but the writer of its status seems to be dead
};

/// Reads the status of the bake in `out`.
/// Errors  The errors of read_status().
Seen look(const std::string& out);

/// Returns JSON for the browser's page: state, status line, completed fraction; "null" if `out` has no readable status.
std::string bake_status_json(const std::string& out);

}  // namespace gigabake::app
