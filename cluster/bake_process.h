/// A rank's bake process as its supervisor sees it: a process without MPI that surveys tiles and bakes cells, and that
/// may die. A hostile file, a GPU fault or the out-of-memory killer then costs what was in hand and nothing else.
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

#include "cluster/child_process.h"
#include "cluster/frame_channel.h"
#include "cluster/hang_watch.h"
#include "scheduler/patience.h"
#include "worker/bake_messages.h"
#include "worker/worker_setup.h"

namespace gigabake {

struct BakeProcessOptions {
  std::filesystem::path program = "/proc/self/exe";  ///< run as PROGRAM bake-process FD
  Patience patience = {};
};

/// So often a process may end before it has started, one after the other; after that no further one would start either.
inline constexpr int max_failed_starts = 3;

/// Runs one process at a time, from the first request on; after a death the next request starts another. From the third
/// death in a row without any result it pauses before that, 1 s, 2 s, 4 s … 60 s: a broken installation does not spin.
/// Not for several threads. The thread that makes requests must outlive the object: the process ends with it.
/// Exact   Results are the bake process's, bit for bit. A request gets one answer or is handed back by one death.
/// Cost    poll() never waits. Beside messages it looks into /proc once a second, while something is in hand.
class BakeProcess {
 public:
  struct Surveyed {
    TileSurvey survey;
  };
  struct Baked {
    CellReport report;
    std::uint32_t attempt;
  };
  /// What was in hand, oldest first, goes back to the owner: nobody works on it any more.
  struct Died {
    std::string why;  ///< "killed by signal 11 (SIGSEGV)", "exit code 1", "hung: no CPU time for 60 s in cell c_0_0_0",
                      ///< "… in its start"
    std::vector<BakeOrder> cells;
    std::vector<std::uint32_t> tiles;
    bool has_started = true;  ///< false: it ended before it could take a request, so no tile and no cell is to blame
  };
  using Event = std::variant<Surveyed, Baked, Died>;

  /// setup.sources is kept: each process that is started gets them.
  BakeProcess(const WorkerSetup& setup, BakeProcessOptions options = {});
  /// Ends the process: see ~ChildProcess.
  ~BakeProcess() = default;
  BakeProcess(const BakeProcess&) = delete;
  BakeProcess& operator=(const BakeProcess&) = delete;

  /// Starts the process, where none runs, without a request: device() follows.
  /// Errors  std::runtime_error, of poll() and requests too: no process can be started here, now or later.
  void prepare();
  /// What the process that runs now, or the last one, bakes on; none until it has said so.
  const std::optional<DeviceAnswer>& device() const { return device_; }
  void submit(CellJob job, std::uint32_t attempt);
  void survey(std::uint32_t tile);
  /// The next event, if there is one. Sends, receives, starts and kills: call it often while something is in hand.
  std::optional<Event> poll();
  /// Returns when poll() may have something to do, at the latest after `longest`.
  void wait(std::chrono::milliseconds longest) const;
  /// Requests without an event so far.
  std::size_t in_hand() const { return cells_.size() + tiles_.size(); }
  /// Of the process that runs now.
  std::optional<pid_t> pid() const;
  /// The most memory that any of its processes had so far.
  std::uint64_t peak_bytes() const;

 private:
  using Clock = HangWatch::Clock;

  void work();
  void start();
  void send_setup();
  void exchange();
  void take(const BakeMessage& message);
  void look_for_hang();
  void end(std::optional<std::string> why);
  void bury();
  void report_death(std::string why);
  void expect_work();
  bool is_paused() const { return !child_ && Clock::now() < not_before_; }
  /// One that has not begun is waited for, though nothing is in hand: it may hang as well.
  bool is_awaited() const { return in_hand() != 0 || !device_; }
  std::string oldest() const;

  const std::vector<std::uint8_t> setup_;
  const std::shared_ptr<const std::vector<std::uint8_t>> sources_;
  const BakeProcessOptions options_;
  std::unique_ptr<ChildProcess> child_;
  std::optional<FrameChannel> channel_;                   ///< none while the process is ending
  std::vector<std::unique_ptr<ChildProcess>> abandoned_;  ///< that the kernel could not end yet
  HangWatch watch_;
  std::deque<BakeOrder> cells_;
  std::deque<std::uint32_t> tiles_;
  Clock::duration cell_since_{}, tile_since_{};  ///< watched time when the front became the oldest
  std::deque<Event> events_;
  std::optional<DeviceAnswer> device_;
  std::optional<std::string> verdict_;  ///< why it was killed, where that was ours
  Clock::time_point ending_since_{}, not_before_{};
  int deaths_in_a_row_ = 0;
  bool has_started_ = false;      ///< the process that runs now, or the last one
  std::uint64_t peak_bytes_ = 0;  ///< of processes that ended
};

/// Errors  std::runtime_error, always: max_failed_starts processes in a row ended before they had started. why: how the
/// last one ended.
[[noreturn]] void throw_no_start(const std::string& why);

}  // namespace gigabake
