#include "viewer/stream/pager.h"

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>
#include <unordered_set>
#include <utility>

#include "core/base/error.h"
#include "viewer/stream/resident_pages.h"

namespace gigabake {
namespace {

struct LoadedPage {
  PageKey key;
  std::optional<Page> page;
  std::uint64_t bytes = 0;
  std::string problem;  ///< set if there is no page
};

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

/// Returns the error with the page's name in front.
std::string problem_with(const PageKey& key, const std::string& what) {
  const std::string part = key.part == PageKey::node_rows ? "nodes"
                           : key.part <= PageKey::listing ? "list of cells"
                                                          : "level " + std::to_string(key.part);
  return "shard " + std::to_string(key.shard) + ", " + part + ", block " + std::to_string(key.block) + ": " + what;
}

LoadedPage read_page(const PageSource& source, const PageKey& key) {
  LoadedPage loaded_page{key, {}, 0, {}};
  try {
    loaded_page.page = source(key);
    loaded_page.bytes = loaded_page.page->bytes();
  } catch (const InputError& error) {
    loaded_page.problem = one_line(error.what());
  } catch (const std::exception& error) {
    loaded_page.problem = one_line(problem_with(key, error.what()));
  } catch (...) {
    loaded_page.problem = problem_with(key, "cannot be read, for an unknown reason");
  }
  return loaded_page;
}

}  // namespace

struct Pager::State {
  State(PageSource page_source, const Options& options);
  ~State();

  bool may_read() const;
  void reader_loop(const std::stop_token& stop);
  void take(LoadedPage loaded_page);
  void list_unused_above(std::uint64_t limit);
  std::uint64_t bytes() const { return pages.bytes() + arrived_bytes; }
  std::uint64_t nearly_full() const { return memory_bytes / 8 * 7; }
  std::uint64_t queued() const { return (queue.size() - next) + reading; }

  template <class Condition>
  bool wait_until(std::chrono::milliseconds maximum, const Condition& holds) {
    std::unique_lock lock(mutex);
    return arrived.wait_for(lock, maximum, holds);
  }

  const PageSource source;
  const std::uint64_t memory_bytes;

  /// The resident pages. Only begin_pass() changes them, except for evictions; find() therefore reads them without the
  /// mutex.
  ResidentPages pages;
  std::unordered_set<PageKey, PageKeyHash> damaged;

  mutable std::mutex mutex;  ///< guards all members below, and evictions
  std::condition_variable_any requested;
  std::condition_variable arrived;
  std::vector<PageKey> queue;  ///< pending from `next` on
  std::size_t next = 0;
  bool first_of_call = false;  ///< no page of this queue was read yet. The first page may exceed the limit; otherwise
                               ///< some passes would never end
  std::uint64_t reading = 0;
  std::unordered_set<PageKey, PageKeyHash> in_flight;  ///< being read, or arrived
  std::vector<LoadedPage> loaded_pages;
  std::uint64_t arrived_bytes = 0, reads = 0, peak_bytes = 0, bytes_read = 0;
  std::vector<std::string> problems;
  std::unordered_set<std::string> known_problems;
  std::vector<std::jthread> readers;
};

Pager::State::State(PageSource page_source, const Options& options)
    : source(std::move(page_source)), memory_bytes(options.memory_bytes) {
  for (int t = 0; t < std::max(1, options.threads); ++t)
    readers.emplace_back([this](const std::stop_token& stop) { reader_loop(stop); });
}

Pager::State::~State() {
  for (std::jthread& reader : readers) reader.request_stop();
}

/// Returns whether the next page may be read. Pages being read are not counted, because their size is not known yet.
bool Pager::State::may_read() const {
  return (first_of_call && reading == 0 && loaded_pages.empty()) || bytes() - pages.candidate_bytes() < memory_bytes;
}

void Pager::State::reader_loop(const std::stop_token& stop) {
  std::unique_lock lock(mutex);
  while (requested.wait(lock, stop, [&] { return next < queue.size(); }) && !stop.stop_requested()) {
    if (!may_read()) {
      next = queue.size();
      arrived.notify_all();
      continue;
    }
    const PageKey key = queue[next++];
    first_of_call = false;
    in_flight.insert(key);
    ++reading;
    lock.unlock();
    LoadedPage loaded_page = read_page(source, key);
    lock.lock();
    --reading;
    take(std::move(loaded_page));
    arrived.notify_all();
  }
}

void Pager::State::take(LoadedPage loaded_page) {
  if (loaded_page.page) {
    ++reads;
    bytes_read += loaded_page.bytes;
    arrived_bytes += loaded_page.bytes;
    pages.evict(memory_bytes - std::min(memory_bytes, arrived_bytes));
    peak_bytes = std::max(peak_bytes, bytes());
  } else if (known_problems.insert(loaded_page.problem).second) {
    problems.push_back(loaded_page.problem);
  }
  loaded_pages.push_back(std::move(loaded_page));
}

/// Lists eviction candidates only if memory use exceeds the limit, because listing visits every page.
void Pager::State::list_unused_above(std::uint64_t limit) {
  if (bytes() > limit)
    pages.list_unused();
  else
    pages.list_none();
}

Pager::Pager(PageSource source, const Options& options) : state_(std::make_unique<State>(std::move(source), options)) {}

Pager::~Pager() = default;

bool Pager::begin_pass() {
  State& s = *state_;
  const std::scoped_lock lock(s.mutex);
  s.list_unused_above(s.memory_bytes);
  s.pages.begin_pass();
  for (LoadedPage& loaded_page : s.loaded_pages) {
    s.in_flight.erase(loaded_page.key);
    if (loaded_page.page)
      s.pages.add(loaded_page.key, std::move(*loaded_page.page), loaded_page.bytes);
    else
      s.damaged.insert(loaded_page.key);
  }
  const bool anything = !s.loaded_pages.empty();
  s.loaded_pages.clear();
  s.arrived_bytes = 0;
  s.pages.evict(s.memory_bytes);
  return anything;
}

const Page* Pager::find(const PageKey& key) const { return state_->pages.find(key); }

bool Pager::is_resident(const PageKey& key) const { return state_->pages.has(key); }

bool Pager::is_damaged(const PageKey& key) const { return state_->damaged.contains(key); }

void Pager::request(const std::vector<PageKey>& by_urgency) {
  State& s = *state_;
  std::unique_lock lock(s.mutex);
  s.list_unused_above(s.nearly_full());
  s.queue.clear();
  s.next = 0;
  s.first_of_call = true;
  std::unordered_set<PageKey, PageKeyHash> seen = s.in_flight;
  for (const PageKey& key : by_urgency)
    if (!s.pages.has(key) && !s.damaged.contains(key) && seen.insert(key).second) s.queue.push_back(key);
  const std::size_t count = std::min(s.queue.size(), s.readers.size());
  lock.unlock();
  // Wakes no reader in vain: a frame calls this function many times, mostly without pages.
  for (std::size_t i = 0; i < count; ++i) s.requested.notify_one();
}

bool Pager::wait(std::chrono::milliseconds maximum) {
  State& s = *state_;
  return s.wait_until(maximum, [&] { return !s.loaded_pages.empty() || s.queued() == 0; });
}

bool Pager::settle(std::chrono::milliseconds maximum) {
  State& s = *state_;
  return s.wait_until(maximum, [&] { return s.queued() == 0; });
}

bool Pager::has_loaded_pages() const {
  const std::scoped_lock lock(state_->mutex);
  return !state_->loaded_pages.empty();
}

bool Pager::may_evict() const {
  // After the eviction of a large page, the pages that stay can take much less than the memory.
  constexpr std::uint64_t recent_passes = 16;
  const State& s = *state_;
  const std::scoped_lock lock(s.mutex);
  return s.bytes() > s.nearly_full() || s.pages.has_evicted_within(recent_passes);
}

PagerCounts Pager::counts() const {
  const State& s = *state_;
  const std::scoped_lock lock(s.mutex);
  return {s.reads, s.bytes(), s.peak_bytes, s.queued(), s.bytes_read};
}

std::vector<std::string> Pager::problems() const {
  const std::scoped_lock lock(state_->mutex);
  return state_->problems;
}

}  // namespace gigabake
