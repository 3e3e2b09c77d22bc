#include "core/base/trace.h"

#include <atomic>

namespace gigabake {
namespace {

std::atomic<TraceSink> receiver{nullptr};

}  // namespace

void set_trace_sink(TraceSink sink) noexcept { receiver = sink; }

TraceSpan::TraceSpan(const char* name, std::string_view what, TraceClock::duration min_time)
    : name_(name), sink_(receiver), min_time_(min_time) {
  if (sink_ == nullptr) return;
  what_ = what;
  start_ = TraceClock::now();
}

TraceSpan::~TraceSpan() {
  if (sink_ == nullptr) return;
  const TraceClock::time_point end = TraceClock::now();
  if (end - start_ >= min_time_) sink_(name_, what_, start_, end);
}

}  // namespace gigabake
