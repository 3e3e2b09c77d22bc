/// What a bake says while it runs: a bar on a terminal, plain lines in a log. On standard error.
#pragma once

#include <chrono>
#include <string>

#include "cluster/bake.h"

namespace gigabake::app {

class Progress {
 public:
  Progress();
  /// Callbacks that point at this object.
  BakeProgress callbacks();

 private:
  using Clock = std::chrono::steady_clock;

  void start_phase();
  void show(const char* what, std::size_t done, std::size_t all);
  void planned(const BakePlan& plan);
  void cell_done(const CellReport& report, const CellJob& job, std::size_t done, std::size_t all);

  bool terminal_;
  Clock::time_point start_, last_shown_;
};

/// 1536 as "1.5 KiB".
std::string readable_bytes(std::uint64_t bytes);

}  // namespace gigabake::app
