/// A command's long work: it says how far it is, and Ctrl-C or SIGTERM stop it.
#pragma once

#include <cstdio>

#include "app/messages/step_display.h"
#include "app/process/stop_signal.h"

namespace gigabake::app {

/// Returns what work(progress) returns; its line is gone from a terminal by then. told: where the steps are told; null:
/// nowhere.
/// Errors  Stopped: by a signal; and what `work` throws.
template <class Work>
auto with_progress(const Work& work, std::FILE* told = stderr) {
  const StopSignals signals;
  StepDisplay display(told, {[] { return stop_signal() != 0; }, {}});
  return work(display.progress());
}

/// Of work that writes nothing: where a step does not hear a signal at once, the process ends all the same.
template <class Work>
auto while_reading(const Work& work, std::FILE* told = stderr) {
  const StopSignals signals;
  StepDisplay display(told, {[] { return stop_signal() != 0; }, [] { end_as_stopped(); }});
  return work(display.progress());
}

}  // namespace gigabake::app
