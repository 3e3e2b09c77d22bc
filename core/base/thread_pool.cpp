#include "core/base/thread_pool.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/work_counts.h"

namespace gigabake {
namespace {

using Body = std::function<void(std::size_t, std::size_t, int)>;

}  // namespace

/// A running loop. An atomic counter dispatches the ranges, so a slow range does not delay other threads.
struct ThreadPool::Loop {
  Body body;
  std::size_t count, grain, ranges;
  std::atomic<std::size_t> next_range{0};
  std::atomic<bool> failed{false};
  std::exception_ptr error;  ///< written by the first thread that sets `failed`
  std::size_t helpers = 0;   ///< number of helpers that run its ranges; guarded by the pool's mutex

  Loop(std::size_t its_count, std::size_t its_grain, Body its_body)
      : body(std::move(its_body)),
        count(its_count),
        grain(std::clamp<std::size_t>(its_grain, 1, std::max<std::size_t>(its_count, 1))),
        ranges(count / grain + (count % grain != 0)) {}

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

  /// Lets helpers join the loop, and wakes at most `wanted` of them.
  void open(Loop& loop, std::size_t wanted) {
    std::unique_lock lock(mutex);
    loops.push_back(&loop);
    asleep = std::max(asleep, std::min(wanted, helpers.size()));
    wake_some(lock);
  }

  /// Waits for the helpers that have joined the loop.
  void close(Loop& loop) {
    std::unique_lock lock(mutex);
    std::erase(loops, &loop);
    if (loops.empty()) asleep = 0;
    left.wait(lock, [&] { return loop.helpers == 0; });
  }

  const int threads;

 private:
  /// Unlocks the mutex and wakes two helpers, which wake others in turn: on a virtual machine, to wake 15 threads takes
  /// a thread 0.1 ms.
  void wake_some(std::unique_lock<std::mutex>& lock) {
    const std::size_t count = std::min<std::size_t>(asleep, 2);
    asleep -= count;
    lock.unlock();
    for (std::size_t i = 0; i < count; ++i) opened.notify_one();
  }

  void help(int thread) {
    std::unique_lock lock(mutex);
    for (Loop* loop = nullptr;;) {
      opened.wait(lock, [&] { return stopping || (loop = loop_to_join()) != nullptr; });
      if (stopping) return;
      ++loop->helpers;
      wake_some(lock);
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
  std::size_t asleep = 0;  ///< helpers that are still to be woken for the loops
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
  Loop loop(count, grain, std::cref(body));
  const bool is_shared = threads() > 1 && loop.ranges > 1;
  if (is_shared) {
    count_work(WorkCounter::joins);
    pool_->open(loop, loop.ranges - 1);
  }
  loop.run(0);
  if (is_shared) pool_->close(loop);
  if (loop.error) std::rethrow_exception(loop.error);
}

ThreadPool::Running ThreadPool::start(std::size_t count, std::size_t grain, Body body) const {
  Running running(*pool_, std::make_unique<Loop>(count, grain, std::move(body)));
  if (count == 0 || threads() == 1) return running;
  count_work(WorkCounter::joins);
  pool_->open(*running.loop_, running.loop_->ranges);
  return running;
}

ThreadPool::Running::Running(Pool& pool, std::unique_ptr<Loop> loop) : pool_(&pool), loop_(std::move(loop)) {}
ThreadPool::Running::Running(Running&&) noexcept = default;

ThreadPool::Running::~Running() {
  if (!loop_) return;
  loop_->failed = true;
  pool_->close(*loop_);
}

void ThreadPool::Running::finish() {
  loop_->run(0);
  pool_->close(*loop_);
  const std::exception_ptr error = loop_->error;
  loop_.reset();
  if (error) std::rethrow_exception(error);
}

const ThreadPool& callers_thread() {
  static const ThreadPool pool(1);
  return pool;
}

}  // namespace gigabake
