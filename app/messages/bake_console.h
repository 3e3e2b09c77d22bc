/// What a bake says while it runs, on standard error.
#pragma once

#include <chrono>
#include <cstdio>

#include "app/messages/alike.h"
#include "app/messages/progress_line.h"
#include "app/messages/step_display.h"
#include "cluster/bake.h"

namespace gigabake::app {

class BakeConsole {
 public:
  /// steps: where the steps before the first cell are told; null: nowhere.
  BakeConsole(std::FILE* steps, StopWish stop);
  /// Callbacks that point at this object: what was opened, surveyed and planned, how far the cells are and
  /// which of them went wrong.
  BakeProgress callbacks();
  /// What follows has standard error for itself.
  void end_step() { steps_.end_step(); }

 private:
  void opened(const SceneSources& sources);
  void surveyed(std::size_t done, std::size_t all);
  void planned(const BakePlan& plan);
  void cell_done(const CellReport& report, const CellJob& job);
  void note(const std::string& line);

  void say(const std::string& line);

  StepDisplay steps_;
  ProgressLine line_;
  AlikeLines alike_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace gigabake::app
