#include "core/base/thread_pool.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "core/base/work_counts.h"

namespace gigabake {
namespace {

using Body = std::function<void(std::size_t, std::size_t, int)>;

/// A running parallel_for(). An atomic counter dispatches the ranges, so a slow range does not delay other threads.
struct Loop {
  const Body& body;
  std::size_t count, grain, ranges;
  std::atomic<std::size_t> next_range{0};
  std::atomic<bool> failed{false};
  std::exception_ptr error;  ///< written by the first thread that sets `failed`
  std::size_t helpers = 0;   ///< number of helpers that run its ranges; guarded by the pool's mutex

  bool has_ranges() const { return next_range < ranges && !failed; }

  void run(int thread) {
    for (std::size_t r = next_range++; r < ranges && !failed; r = next_range++) {
      try {
        body(r * grain, std::min(count, (r + 1) * grain), thread);
      } catch (...) {
        if (!failed.exchange(true)) error = std::current_exception();
      }
    }
  }
};

}  // namespace

/// The threads of a pool. A helper sleeps until a loop has ranges left, and joins the loop with the min number of
/// helpers. It then searches for another loop. The caller also runs ranges. It waits only for helpers that joined its
/// loop, not for helpers that wake too late.
struct ThreadPool::Pool {
  explicit Pool(int thread_count) : threads(std::max(1, thread_count)) {
    try {
      for (int t = 1; t < threads; ++t) helpers.emplace_back([this, t] { help(t); });
    } catch (...) {
      dismiss();
      throw;
    }
  }
  ~Pool() { dismiss(); }

  void run(Loop& loop) {
    {
      const std::scoped_lock lock(mutex);
      loops.push_back(&loop);
    }
    wake(loop.ranges - 1);
    loop.run(0);
    std::unique_lock lock(mutex);
    std::erase(loops, &loop);
    left.wait(lock, [&] { return loop.helpers == 0; });
  }

  const int threads;

 private:
  void wake(std::size_t wanted) {
    if (wanted >= helpers.size()) return opened.notify_all();
    for (std::size_t i = 0; i < wanted; ++i) opened.notify_one();
  }

  void help(int thread) {
    std::unique_lock lock(mutex);
    for (Loop* loop = nullptr;;) {
      opened.wait(lock, [&] { return stopping || (loop = loop_to_join()) != nullptr; });
      if (stopping) return;
      ++loop->helpers;
      lock.unlock();
      loop->run(thread);
      lock.lock();
      if (--loop->helpers == 0) left.notify_all();
    }
  }

  Loop* loop_to_join() const {
    Loop* found = nullptr;
    for (Loop* loop : loops)
      if (loop->has_ranges() && (found == nullptr || loop->helpers < found->helpers)) found = loop;
    return found;
  }

  void dismiss() {
    {
      const std::scoped_lock lock(mutex);
      stopping = true;
    }
    opened.notify_all();
    for (auto& helper : helpers) helper.join();
  }

  std::mutex mutex;  ///< guards the members below except `helpers`, and `Loop::helpers`
  std::condition_variable opened, left;
  std::vector<Loop*> loops;
  bool stopping = false;
  std::vector<std::thread> helpers;
};

ThreadPool::ThreadPool(int threads) : pool_(std::make_unique<Pool>(threads)) {}
ThreadPool::~ThreadPool() = default;
ThreadPool::ThreadPool(ThreadPool&&) noexcept = default;
ThreadPool& ThreadPool::operator=(ThreadPool&&) noexcept = default;

int ThreadPool::threads() const { return pool_->threads; }

void ThreadPool::parallel_for(std::size_t count, std::size_t grain, const Body& body) const {
  if (count == 0) return;
  grain = std::clamp<std::size_t>(grain, 1, count);
  const std::size_t ranges = count / grain + (count % grain != 0);
  if (threads() == 1 || ranges == 1) {
    for (std::size_t r = 0; r < ranges; ++r) body(r * grain, std::min(count, (r + 1) * grain), 0);
    return;
  }
  Loop loop{body, count, grain, ranges, {}, {}, {}, {}};
  count_work(WorkCounter::joins);
  pool_->run(loop);
  if (loop.error) std::rethrow_exception(loop.error);
}

const ThreadPool& callers_thread() {
  static const ThreadPool pool(1);
  return pool;
}

}  // namespace gigabake
