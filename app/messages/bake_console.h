/// Messages of a running bake on standard error.
#pragma once

#include <cstdio>

#include "app/messages/progress_line.h"
#include "app/messages/similar_lines.h"
#include "app/messages/step_display.h"
#include "cluster/bake/bake.h"

namespace gigabake::app {

class BakeConsole {
 public:
  /// `steps` is the stream for the steps before the first cell; null prints no steps.
  BakeConsole(std::FILE* steps, StopCallbacks stop);
  /// Returns a progress that refers to this object. Its steps and listener print opened sources, the scan, the plan,
  /// the progress of the cells and their warnings.
  BakeProgress progress();
  /// Ends the current step's line, so that the caller can print to standard error.
  void end_step() { steps_.end_step(); }

 private:
  void take(const BakeEvent& event);
  void opened(const SceneSources& sources);
  void planned(const BakePlan& plan);
  void note(const std::string& line);

  void say(const std::string& line);

  StepDisplay steps_;
  ProgressLine line_;
  SimilarLineFilter similar_lines_;
};

}  // namespace gigabake::app
