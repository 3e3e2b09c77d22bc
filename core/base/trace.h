/// Time stamps of the steps of a process, for finding what a run waits for. format/system/meters/trace_file.h records
/// them.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace gigabake {

using TraceClock = std::chrono::steady_clock;

/// Receiver of the steps of all threads. `name` is a literal, `what` the object of the step, such as a cell.
using TraceSink = void (*)(const char* name, const std::string& what, TraceClock::time_point start,
                           TraceClock::time_point end);

/// Sets the receiver, before the first step. Without a receiver, steps are not recorded.
void set_trace_sink(TraceSink sink) noexcept;

/// A step of the calling thread, from the construction to the destruction. Steps shorter than `min_time` are not
/// recorded.
/// Cost    Without a receiver, one comparison.
class TraceSpan {
 public:
  explicit TraceSpan(const char* name, std::string_view what = {}, TraceClock::duration min_time = {});
  ~TraceSpan();
  TraceSpan(const TraceSpan&) = delete;
  TraceSpan& operator=(const TraceSpan&) = delete;

 private:
  const char* name_;
  TraceSink sink_;  ///< null: nothing is recorded
  std::string what_;
  TraceClock::duration min_time_;
  TraceClock::time_point start_;
};

}  // namespace gigabake
