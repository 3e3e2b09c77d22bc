/// Wrappers for long work of a command: they print progress and stop on Ctrl-C or SIGTERM.
#pragma once

#include <cstdio>

#include "app/messages/step_display.h"
#include "app/process/stop_signal.h"

namespace gigabake::app {

/// Returns the result of work(progress), after clearing its line on a terminal. `told`: stream for the progress; null:
/// print none.
/// Errors  Stopped: a signal arrived; and the exceptions of `work`.
template <class Work>
auto with_progress(const Work& work, std::FILE* told = stderr) {
  const StopSignals signals;
  StepDisplay display(told, {[] { return stop_signal() != 0; }, {}});
  return work(display.progress());
}

/// Like with_progress(), for work that writes no files: if a step ignores a stop signal for half a second, the process
/// ends.
template <class Work>
auto while_reading(const Work& work, std::FILE* told = stderr) {
  const StopSignals signals;
  StepDisplay display(told, {[] { return stop_signal() != 0; }, [] { exit_as_stopped(); }});
  return work(display.progress());
}

}  // namespace gigabake::app
