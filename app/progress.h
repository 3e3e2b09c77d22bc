/// What a bake says while it runs, on standard error.
#pragma once

#include <chrono>

#include "app/progress_line.h"
#include "cluster/bake.h"

namespace gigabake::app {

class Progress {
 public:
  Progress();
  /// Callbacks that point at this object: what was opened, surveyed and planned, how far the cells are and
  /// which of them went wrong.
  BakeProgress callbacks();

 private:
  void opened(const SceneSources& sources);
  void surveyed(std::size_t done, std::size_t all);
  void planned(const BakePlan& plan);
  void cell_done(const CellReport& report, const CellJob& job);

  ProgressLine line_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace gigabake::app
