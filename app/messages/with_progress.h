/// Wrappers for long work of a command: they print progress and stop on Ctrl-C or SIGTERM.
#pragma once

#include <cstdio>

#include "app/messages/step_display.h"
#include "app/process/stop_signal.h"

namespace gigabake::app {

/// Runs work(progress), clears the progress line on a terminal, and returns the result of `work`. Progress is printed
/// to `output`; null prints no progress.
/// Errors  Stopped: a signal arrived; and the exceptions of `work`.
template <class Work>
auto with_progress(const Work& work, std::FILE* output = stderr) {
  const StopSignals signals;
  StepDisplay display(output, {[] { return stop_signal() != 0; }, {}});
  return work(display.progress());
}

/// Runs `work` like with_progress(). The work must not write files: if a step ignores a stop signal for half a second,
/// the process ends.
template <class Work>
auto while_reading(const Work& work, std::FILE* output = stderr) {
  const StopSignals signals;
  StepDisplay display(output, {[] { return stop_signal() != 0; }, [] { exit_as_stopped(); }});
  return work(display.progress());
}

}  // namespace gigabake::app
