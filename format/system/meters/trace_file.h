/// File of time stamps, in the trace event format of Chrome, which ui.perfetto.dev displays.
#pragma once

namespace gigabake {

/// Records the steps of this process (core/base/trace.h) in the file PREFIX.PID.json if the environment variable
/// GIGABAKE_TRACE is PREFIX. Call it once, before other threads start.
/// Cost    One line of text and one system call per step.
void record_trace();

}  // namespace gigabake
