/// The supervisor's view of a rank's bake process, which scans tiles and bakes cells without MPI and may die. A hostile
/// file, a GPU fault or the out-of-memory killer then affects only the requests in flight.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "cluster/process/child_process.h"
#include "cluster/process/frame_channel.h"
#include "cluster/process/hang_watch.h"
#include "scheduler/queue/timeouts.h"
#include "worker/pipeline/bake_messages.h"
#include "worker/pipeline/worker_setup.h"

namespace gigabake {

struct BakeProcessOptions {
  std::filesystem::path program = "/proc/self/exe";  ///< run as PROGRAM bake-process FD
  Timeouts timeouts = {};
};

/// Max number of consecutive processes that end before they have started. Callers then start no further process.
inline constexpr int max_failed_starts = 3;

/// A supervisor of at most one bake process. The first request starts the process. After a death, the next request
/// starts another process. After the third consecutive death without any result, each start is delayed by 1 s, 2 s, 4 s
/// … 60 s. The delay keeps a broken installation from restarting in a tight loop.
/// Not thread-safe. The thread that makes requests must outlive the object, because the process ends with that thread.
/// Exact   Results are the bake process's, bit for bit. Each request gets one answer, or is returned by one Died event.
/// Cost    poll() never blocks. While requests are in flight it reads /proc once per second.
class BakeProcess {
 public:
  struct Scanned {
    TileScan scan;
  };
  struct Baked {
    CellReport report;
    std::uint32_t attempt;
    RunWork work;                          ///< the process's work since its previous answer
    std::vector<std::uint8_t> child = {};  ///< see BakeAnswer
  };
  /// The death of the process, with the requests that were in flight, oldest first. The caller may submit them again.
  struct Died {
    std::string why;  ///< "killed by signal 11 (SIGSEGV)", "exit code 1", "hung: no CPU time for 60 s in cell c_0_0_0",
                      ///< "… in its start"
    std::vector<BakeOrder> cells;
    std::vector<std::uint32_t> tiles;
    bool has_started = true;  ///< false: it ended before it accepted requests, so no tile or cell is the cause
  };
  using Event = std::variant<Scanned, Baked, Died>;

  /// Keeps setup.sources, because every process that is started receives them. `early` is a process that
  /// start_early() started; it becomes the first process. null: none.
  BakeProcess(const WorkerSetup& setup, BakeProcessOptions options = {}, std::unique_ptr<ChildProcess> early = nullptr);
  /// Ends the process: see ~ChildProcess.
  ~BakeProcess() = default;
  BakeProcess(const BakeProcess&) = delete;
  BakeProcess& operator=(const BakeProcess&) = delete;

  /// Starts the process, if none runs, without a request; device() becomes available later.
  /// Errors  std::runtime_error, also from poll(), submit() and scan(): no process can ever be started on this host.
  void prepare();
  /// Returns the device of the current or last process; nullopt until the process has reported its device.
  const std::optional<DeviceAnswer>& device() const { return device_; }
  void submit(BakeOrder order);
  void submit(CellJob job, std::uint32_t attempt) { submit(BakeOrder{std::move(job), attempt}); }
  void scan(std::uint32_t tile);
  /// Returns the next event, if any. Also sends and receives messages, and starts or kills the process. Call it often
  /// while requests are in flight.
  std::optional<Event> poll();
  /// Returns when poll() may have something to do, or after `maximum`.
  void wait(std::chrono::milliseconds maximum) const;
  /// Returns the number of requests without an event.
  std::size_t in_flight() const { return cells_.size() + tiles_.size(); }
  /// Returns the id of the running process.
  std::optional<pid_t> pid() const;
  /// Returns the max peak memory in bytes of all processes that this object has started.
  std::uint64_t peak_bytes() const;

 private:
  using Clock = HangWatch::Clock;

  void work();
  void start();
  void send_setup();
  void exchange();
  void take(const BakeMessage& message);
  void check_for_hang();
  void end(std::optional<std::string> why);
  void report_end();
  void report_death(std::string why);
  void expect_work();
  bool is_paused() const { return !child_ && Clock::now() < not_before_; }
  /// Returns true if a hang must be detected: requests are in flight, or the process has not yet reported its device.
  bool must_watch() const { return in_flight() != 0 || !device_; }
  std::string oldest() const;

  const std::vector<std::uint8_t> setup_;
  const std::shared_ptr<const std::vector<std::uint8_t>> sources_;
  const BakeProcessOptions options_;
  std::unique_ptr<ChildProcess> early_;  ///< until it becomes child_
  std::unique_ptr<ChildProcess> child_;
  std::optional<FrameChannel> channel_;                   ///< none while the process is ending
  std::vector<std::unique_ptr<ChildProcess>> abandoned_;  ///< processes that the kernel could not end yet
  HangWatch watch_;
  std::deque<BakeOrder> cells_;
  std::deque<std::uint32_t> tiles_;
  Clock::duration cell_since_{}, tile_since_{};  ///< watched time at which the first request in the queue became first
  std::deque<Event> events_;
  std::optional<DeviceAnswer> device_;
  std::optional<std::string> kill_reason_;  ///< reason, if this object killed the process
  Clock::time_point ending_since_{}, not_before_{};
  int deaths_in_a_row_ = 0;
  bool has_started_ = false;      ///< of the current or last process
  std::uint64_t peak_bytes_ = 0;  ///< of processes that ended
};

/// Starts a bake process before its setup is known, so that its device starts while this process starts MPI and opens
/// the source. `expected` is the request that the setup will probably contain; another one only costs time. The caller
/// must outlive the process, as described for BakeProcess. Returns null if the process cannot be started now.
std::unique_ptr<ChildProcess> start_early(const DeviceRequest& expected, const BakeProcessOptions& options = {});

/// Returns the line for a process that ended before it had started. `why` states how it ended.
std::string no_start_error(const std::string& why);

/// Throws the error for max_failed_starts consecutive processes that ended before they had started. `why` states how
/// the last process ended.
/// Errors  std::runtime_error, always.
[[noreturn]] void throw_no_start(const std::string& why);

}  // namespace gigabake
