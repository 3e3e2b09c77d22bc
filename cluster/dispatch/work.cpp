#include <chrono>
#include <string>
#include <utility>

#include "cluster/dispatch/dispatch.h"
#include "cluster/dispatch/rank_baker.h"
#include "cluster/mpi/heartbeat.h"

namespace gigabake {
namespace {

constexpr std::chrono::milliseconds max_sleep{2};

/// Rank 0 counts as lost after this many heartbeat timeouts without a message from it. While rank 0 dispatches cells,
/// it sends several messages within one timeout.
constexpr double heartbeat_timeouts_of_master = 4;

/// The main loop of a rank other than 0.
class Worker {
 public:
  Worker(MpiSession& mpi, BakeProcess& process, double heartbeat_timeout_s)
      : mpi_(mpi),
        process_(process),
        baker_(process),
        heartbeat_timeout_s_(heartbeat_timeout_s),
        max_silence_s_(mpi.collective_timeout_s()) {}

  void run() {
    while (!stopped_) {
      signs_.show();
      while (const auto message = mpi_.poll()) handle(*message);
      while (auto answer = baker_.answer()) mpi_.send(0, answer->tag, std::move(answer->bytes));
      expect_master();
      process_.wait(max_sleep);
    }
  }

 private:
  /// Throws RankLost if rank 0 is lost. Without this check, no rank would end a launch whose rank 0 was suspended.
  void expect_master() {
    const auto now = Clock::now();
    if (now - turned_ > own_pause) heard_ = now;  // this rank was suspended, so messages may be pending
    turned_ = now;
    const double silent_s = std::chrono::duration<double>(now - heard_).count();
    if (stopped_ || silent_s < max_silence_s_) return;
    throw RankLost("no message from rank 0 for " + std::to_string(std::int64_t(silent_s)) +
                   " s; run the same command again, without its host");
  }

  void handle(const Message& message) {
    heard_ = Clock::now();
    // Before its first message, rank 0 may need longer to examine OUT.
    max_silence_s_ = heartbeat_timeouts_of_master * heartbeat_timeout_s_;
    if (message.tag == tag_stop) stopped_ = true;
    if (message.tag == tag_job) baker_.handle(message.bytes);
  }

  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds own_pause{2};

  MpiSession& mpi_;
  BakeProcess& process_;
  RankBaker baker_;
  const double heartbeat_timeout_s_;
  double max_silence_s_;
  Clock::time_point heard_ = Clock::now(), turned_ = Clock::now();
  HeartbeatSender signs_{mpi_, process_};
  bool stopped_ = false;
};

}  // namespace

void work(MpiSession& mpi, BakeProcess& process, double heartbeat_timeout_s) {
  Worker(mpi, process, heartbeat_timeout_s).run();
}

}  // namespace gigabake
