#include <chrono>
#include <string>
#include <variant>

#include "cluster/dispatch.h"
#include "cluster/signs_of_life.h"
#include "cluster/tags.h"
#include "lattice/bytes.h"

namespace gigabake {
namespace {

constexpr std::chrono::milliseconds longest_turn{2};

/// Rank 0 says something several times within this many silences while it hands out cells.
constexpr double silences_of_the_master = 4;

/// A rank's loop.
class Worker {
 public:
  Worker(MpiSession& mpi, BakeProcess& process, double silence_s)
      : mpi_(mpi), process_(process), silence_s_(silence_s), longest_silence_s_(mpi.patience_s()) {}

  void run() {
    while (!stopped_) {
      signs_.show();
      while (const auto message = mpi_.poll()) obey(*message);
      while (auto event = process_.poll()) report(*event);
      expect_master();
      process_.wait(longest_turn);
    }
  }

 private:
  /// Without it nobody would end a launch whose rank 0 was stopped.
  void expect_master() {
    const auto now = Clock::now();
    if (now - turned_ > own_pause) heard_ = now;  // this rank was stopped itself: what was sent is still on its way
    turned_ = now;
    const double silent_s = std::chrono::duration<double>(now - heard_).count();
    if (stopped_ || silent_s < longest_silence_s_) return;
    throw RankLost("nothing heard of rank 0 for " + std::to_string(std::int64_t(silent_s)) +
                   " s; run the same command again, without its host");
  }

  void obey(const Message& message) {
    heard_ = Clock::now();
    longest_silence_s_ = silences_of_the_master * silence_s_;  // before its first word it may look through OUT
    if (message.tag == tag_stop) stopped_ = true;
    if (message.tag != tag_job) return;
    // Sent before the master knew of the last death: it counts the cell among those that died with the process.
    std::uint32_t known_deaths = 0;
    ByteReader(message.bytes, "job").get(known_deaths);
    if (known_deaths != deaths_) return;
    BakeOrder order = order_from_bytes(std::span(message.bytes).subspan(sizeof deaths_));
    process_.submit(std::move(order.job), order.attempt);
  }

  void report(const BakeProcess::Event& event) {
    if (const auto* baked = std::get_if<BakeProcess::Baked>(&event))
      mpi_.send(0, tag_report, to_bytes(BakeAnswer{baked->report, baked->attempt}));
    if (const auto* died = std::get_if<BakeProcess::Died>(&event)) {
      ++deaths_;
      mpi_.send(0, tag_died, {died->why.begin(), died->why.end()});
    }
  }

  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds own_pause{2};

  MpiSession& mpi_;
  BakeProcess& process_;
  const double silence_s_;
  double longest_silence_s_;
  Clock::time_point heard_ = Clock::now(), turned_ = Clock::now();
  SignsOfLife signs_{mpi_, process_};
  std::uint32_t deaths_ = 0;
  bool stopped_ = false;
};

}  // namespace

void work(MpiSession& mpi, BakeProcess& process, double silence_s) { Worker(mpi, process, silence_s).run(); }

}  // namespace gigabake
