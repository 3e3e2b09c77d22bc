#include "viewer/web/reply_threads.h"

#include <system_error>
#include <utility>

namespace gigabake {

bool ReplyThreads::start(std::function<void()> work) {
  const std::lock_guard lock(mutex_);
  running_.remove_if([](Running& one) {
    if (!one.done) return false;
    one.thread.join();
    return true;
  });
  if (finished_ || running_.size() >= max_count_) return false;
  Running& one = running_.emplace_back();
  try {
    one.thread = std::thread([&one, does = std::move(work)] {
      does();
      one.done = true;
    });
  } catch (const std::system_error&) {
    running_.pop_back();
    return false;
  }
  return true;
}

void ReplyThreads::finish() {
  std::list<Running> left;
  {
    const std::lock_guard lock(mutex_);
    finished_ = true;
    left.splice(left.end(), running_);
  }
  for (Running& one : left) one.thread.join();
}

}  // namespace gigabake
