#include "bench/schedule_bench.h"

#include <algorithm>
#include <queue>
#include <sys/resource.h>
#include <tuple>

#include "bench/bench_scene.h"

namespace gigabake::bench {
namespace {

enum class Kind : std::uint8_t { report, death, killed, restart, silence, watch };

struct Event {
  double at_s = 0;
  std::uint64_t number = 0;  ///< number that orders events of the same time
  Kind kind = Kind::watch;
  int worker = 0;
  std::uint32_t process = 0;  ///< number of the worker's process; events of a dead process are ignored
  std::uint32_t job = 0, attempt = 0;
  bool operator>(const Event& o) const { return std::tie(at_s, number) > std::tie(o.at_s, o.number); }
};

struct SimulatedWorker {
  double read_free_s = 0, kernels_free_s = 0, write_free_s = 0;
  double mute_until_s = 0;
  std::uint32_t process = 0;
  bool restarting = false;
  std::optional<std::uint32_t> last;
};

bool share_a_tile(const CellJob& a, const CellJob& b) {
  return std::any_of(a.tiles.begin(), a.tiles.end(),
                     [&b](std::uint32_t t) { return std::binary_search(b.tiles.begin(), b.tiles.end(), t); });
}

/// Selects up to `number` cells at random; a cell may be selected twice.
std::vector<bool> some_cells(int number, std::uint32_t cells, std::uint64_t seed) {
  std::vector<bool> chosen(cells, false);
  for (int i = 0; i < number; ++i) chosen[std::size_t(uniform(seed, std::uint64_t(i)) * cells)] = true;
  return chosen;
}

/// Measures the time of every call of the schedule.
class StopWatch {
 public:
  template <class Call>
  auto operator()(const Call& call) {
    struct Lap {
      double& sum_s;
      Clock::time_point start = Clock::now();
      ~Lap() { sum_s += seconds_since(start); }
    } lap{sum_s_};
    return call();
  }
  double seconds() const { return sum_s_; }

 private:
  double sum_s_ = 0;
};

class Simulation {
 public:
  Simulation(const ScheduleBenchRequest& request, const std::vector<CellJob>& jobs, ScheduleBench& out)
      : request_(request),
        jobs_(jobs),
        out_(out),
        fails_(some_cells(request.failing_cells, request.cells, request.seed + 1)),
        kills_(some_cells(request.killing_cells, request.cells, request.seed + 2)),
        is_done_(jobs.size(), false),
        workers_(std::size_t(request.workers)),
        schedule_(jobs, request.schedule) {}

  void run() {
    out_.lower_bound_s = lower_bound();
    inject(Kind::death, request_.deaths, request_.seed + 3);
    inject(Kind::silence, request_.silences, request_.seed + 4);
    push({.at_s = watch_every_s()});
    for (int w = 0; w < request_.workers; ++w) timed_([&] { schedule_.heard_from(w, now_s_); });
    for (int round = 0; round < request_.schedule.slots; ++round)
      for (int w = 0; w < request_.workers; ++w) give(w);
    while (!schedule_.is_over()) {
      const Event e = events_.top();
      events_.pop();
      now_s_ = e.at_s;
      handle(e);
    }
    out_.makespan_s = now_s_;
    out_.schedule_s = timed_.seconds();
    check_ends();
  }

 private:
  double watch_every_s() const { return request_.schedule.heartbeat_timeout_s / 4; }

  void push(Event e) {
    e.number = pushed_++;
    events_.push(e);
  }

  void inject(Kind kind, int number, std::uint64_t seed) {
    for (int i = 0; i < number; ++i) {
      const auto worker = int(uniform(seed, std::uint64_t(2 * i)) * request_.workers);
      push({.at_s = uniform(seed, std::uint64_t(2 * i + 1)) * out_.lower_bound_s, .kind = kind, .worker = worker});
    }
  }

  double lower_bound() const {
    double slowest = 0, maximum = 0;
    for (const CellJob& job : jobs_) {
      const StageTimes t = true_times(job, request_.seed);
      slowest += std::max({t.read_s, t.kernels_s, t.write_s});
      maximum = std::max(maximum, t.sum());
    }
    return std::max(slowest / request_.workers, maximum);
  }

  /// Dispatches one more cell to the worker. Returns false if the schedule has no cell for this worker.
  bool give(int worker) {
    SimulatedWorker& w = workers_[std::size_t(worker)];
    if (w.restarting) return false;
    const auto a = timed_([&] { return schedule_.next(worker, now_s_); });
    if (!a) return false;
    ++out_.dispatches;
    out_.retries += a->attempt > 1 ? 1 : 0;
    out_.followers += w.last && share_a_tile(jobs_[*w.last], jobs_[a->job]) ? 1 : 0;
    w.last = a->job;
    bake(worker, *a);
    return true;
  }

  /// Computes when the cell's report arrives or its process dies. The times are final, because later cells queue behind
  /// this cell.
  void bake(int worker, const Assignment& a) {
    SimulatedWorker& w = workers_[std::size_t(worker)];
    const StageTimes t = true_times(jobs_[a.job], request_.seed);
    w.read_free_s = std::max(now_s_ + message_s, w.read_free_s) + t.read_s;
    w.kernels_free_s = std::max(w.read_free_s, w.kernels_free_s) + t.kernels_s;
    if (kills_[a.job])
      return push({.at_s = w.kernels_free_s, .kind = Kind::killed, .worker = worker, .process = w.process});
    w.write_free_s = std::max(w.kernels_free_s, w.write_free_s) + t.write_s;
    push({w.write_free_s + message_s, 0, Kind::report, worker, w.process, a.job, a.attempt});
  }

  void handle(const Event& e) {
    SimulatedWorker& w = workers_[std::size_t(e.worker)];
    if (e.kind == Kind::watch) return watch();
    if (e.kind == Kind::silence) {
      w.mute_until_s = now_s_ + 2 * request_.schedule.heartbeat_timeout_s;
    } else if (now_s_ < w.mute_until_s) {
      Event later = e;
      later.at_s = w.mute_until_s;
      push(later);
    } else if (e.kind == Kind::death) {
      if (!w.restarting) die(e.worker);
    } else if (e.kind == Kind::restart) {
      w.restarting = false;
      ask_everybody();
    } else if (e.process == w.process) {
      e.kind == Kind::killed ? die(e.worker) : report(e);
    }
  }

  void report(const Event& e) {
    const bool fails = fails_[e.job];
    const Verdict verdict = timed_([&] {
      return fails ? schedule_.failed(e.worker, e.job, e.attempt, "injected", now_s_)
                   : schedule_.finished(e.worker, e.job, e.attempt, now_s_);
    });
    if (verdict == Verdict::stale) ++out_.stale;
    if (verdict == Verdict::accepted && !fails) {
      out_.differ |= is_done_[e.job];
      is_done_[e.job] = true;
    }
    if (fails) return ask_everybody();
    while (give(e.worker)) continue;
  }

  void die(int worker) {
    SimulatedWorker& w = workers_[std::size_t(worker)];
    ++w.process;
    w.restarting = true;
    w.read_free_s = w.kernels_free_s = w.write_free_s = 0;
    timed_([&] { schedule_.process_died(worker, "injected", now_s_); });
    push({.at_s = now_s_ + restart_s, .kind = Kind::restart, .worker = worker});
    ask_everybody();
  }

  /// Sends the heartbeats of all workers that are not mute, and marks workers as lost after the heartbeat timeout.
  void watch() {
    for (int w = 0; w < request_.workers; ++w)
      if (now_s_ >= workers_[std::size_t(w)].mute_until_s) timed_([&] { schedule_.heard_from(w, now_s_); });
    out_.lost_workers += int(timed_([&] { return schedule_.silent(now_s_); }).size());
    ask_everybody();
    push({.at_s = now_s_ + watch_every_s()});
  }

  void ask_everybody() {
    for (int w = 0; w < request_.workers; ++w)
      while (give(w)) continue;
  }

  void check_ends() {
    out_.counts = schedule_.counts();
    for (std::uint32_t j = 0; j < jobs_.size(); ++j)
      out_.differ |= is_done_[j] != (schedule_.state(j) == JobState::done);
    out_.differ |= out_.counts.done + out_.counts.failed + out_.counts.abandoned != jobs_.size();
  }

  const ScheduleBenchRequest& request_;
  const std::vector<CellJob>& jobs_;
  ScheduleBench& out_;
  std::vector<bool> fails_, kills_, is_done_;
  std::vector<SimulatedWorker> workers_;
  Schedule schedule_;
  std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
  std::uint64_t pushed_ = 0;
  double now_s_ = 0;
  StopWatch timed_;
};

std::uint64_t peak_rss_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::uint64_t(usage.ru_maxrss) * 1024;
}

}  // namespace

ScheduleBench bench_schedule(const ScheduleBenchRequest& request) {
  ScheduleBench out;
  out.cells = request.cells;
  out.workers = request.workers;
  out.seed = request.seed;
  std::vector<TileScan> scans = terrain_scans(request.cells, request.seed);
  SceneSources sources;
  sources.tiles.resize(scans.size());
  BakeParameters parameters;
  parameters.voxel_size_m = 0.125;
  parameters.cell_voxels = 512;
  const auto start = Clock::now();
  const BakePlan plan = make_plan(std::move(scans), sources, parameters);
  out.plan_s = seconds_since(start);
  Simulation(request, plan.jobs, out).run();
  out.peak_rss_bytes = peak_rss_bytes();
  return out;
}

}  // namespace gigabake::bench
