#include "cluster/process/hang_watch.h"

#include <algorithm>

namespace gigabake {

HangWatch::HangWatch(Clock::duration stall)
    : stall_(stall), interval_(std::min<Clock::duration>(stall / 8, std::chrono::seconds(1))) {}

void HangWatch::start(Clock::time_point now) {
  last_look_ = now;
  progress_ = watched_;
}

void HangWatch::look(Clock::time_point now, const std::optional<ProcessActivity>& activity,
                     std::uint64_t message_bytes) {
  watched_ += std::min(now - last_look_, stall_ / 4);
  last_look_ = now;
  if (!activity || *activity != last_activity_ || message_bytes != last_message_bytes_) progress_ = watched_;
  last_activity_ = activity.value_or(ProcessActivity());
  last_message_bytes_ = message_bytes;
}

}  // namespace gigabake
