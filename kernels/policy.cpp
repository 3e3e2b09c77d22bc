#include "kernels/policy.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace gigabake::kernels {
namespace {

using Body = std::function<void(std::size_t, std::size_t, int)>;

/// One parallel_for: ranges are handed out by a counter, so that a slow range delays nobody else.
struct Loop {
  const Body& body;
  std::size_t count, grain, ranges;
  std::atomic<std::size_t> next_range{0};
  std::atomic<bool> failed{false};
  std::exception_ptr error;  ///< written by whoever sets `failed` first

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

/// Helpers sleep on `generation`. A loop opens the door, works itself, shuts the door when no range is left and waits
/// only for the helpers that came in: one that woke too late costs nothing.
struct CpuPolicy::Pool {
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
    const std::scoped_lock one_loop_at_a_time(callers);
    current = &loop;
    door.store(open);
    wake(loop.ranges - 1);
    loop.run(0);
    for (auto inside = door.fetch_and(~open) & ~open; inside != 0; inside = door.load()) door.wait(inside);
  }

  const int threads;

 private:
  static constexpr std::uint32_t open = 1u << 31;  ///< the door's other bits count the helpers inside

  void wake(std::size_t wanted) {
    ++generation;
    if (wanted >= helpers.size()) return generation.notify_all();
    for (std::size_t i = 0; i < wanted; ++i) generation.notify_one();
  }

  void help(int thread) {
    for (std::uint32_t seen = 0;; seen = generation.load()) {
      if (stopping) return;
      if (enter()) {
        current->run(thread);
        if (--door == 0) door.notify_all();
      }
      generation.wait(seen);
    }
  }

  bool enter() {
    std::uint32_t state = door.load();
    while (state & open)
      if (door.compare_exchange_weak(state, state + 1)) return true;
    return false;
  }

  void dismiss() {
    stopping = true;
    ++generation;
    generation.notify_all();
    for (auto& helper : helpers) helper.join();
  }

  std::mutex callers;
  std::atomic<std::uint32_t> generation{0}, door{0};
  std::atomic<bool> stopping{false};
  Loop* current = nullptr;  ///< valid while the door is open or somebody is inside
  std::vector<std::thread> helpers;
};

CpuPolicy::CpuPolicy(int threads) : pool_(std::make_unique<Pool>(threads)) {}
CpuPolicy::~CpuPolicy() = default;
CpuPolicy::CpuPolicy(CpuPolicy&&) noexcept = default;
CpuPolicy& CpuPolicy::operator=(CpuPolicy&&) noexcept = default;

int CpuPolicy::threads() const { return pool_->threads; }

void CpuPolicy::parallel_for(std::size_t count, std::size_t grain, const Body& body) const {
  if (count == 0) return;
  grain = std::clamp<std::size_t>(grain, 1, count);
  const std::size_t ranges = count / grain + (count % grain != 0);
  if (threads() == 1 || ranges == 1) {
    for (std::size_t r = 0; r < ranges; ++r) body(r * grain, std::min(count, (r + 1) * grain), 0);
    return;
  }
  Loop loop{body, count, grain, ranges, {}, {}, {}};
  pool_->run(loop);
  if (loop.error) std::rethrow_exception(loop.error);
}

}  // namespace gigabake::kernels
