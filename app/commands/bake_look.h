/// A bake as its folder shows it.
#pragma once

#include <string>

#include "scheduler/bake_status.h"

namespace gigabake::app {

struct Seen {
  BakeStatus status;
  double now_s = 0;
  bool interrupted = false;  ///< it says that it goes on, and nobody is there any more
};

/// Errors  as read_status().
Seen look(const std::string& out);

/// For the browser's page: state, one line, the share done; "null" where OUT has no readable status.
std::string bake_status_json(const std::string& out);

}  // namespace gigabake::app
