/// What a bake says while it runs: a bar on a terminal, plain lines in a log. On standard error.
#pragma once

#include <chrono>

#include "cluster/bake.h"

namespace gigabake::app {

class Progress {
 public:
  Progress();
  /// Callbacks that point at this object.
  BakeProgress callbacks();

 private:
  void cell_done(const CellReport& report, const CellJob& job, std::size_t done, std::size_t all);

  bool terminal_;
  std::chrono::steady_clock::time_point start_, last_line_;
};

/// 1536 as "1.5 KiB".
std::string readable_bytes(std::uint64_t bytes);

}  // namespace gigabake::app
