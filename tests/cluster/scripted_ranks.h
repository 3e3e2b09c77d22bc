/// Ranks that a test scripts: their clock, their results, their deaths and stalls, and their malformed messages.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "cluster/mpi/rank_link.h"
#include "format/job/cell_job.h"

namespace gigabake {

/// Simulated ranks. Time passes only in wait(). A rank works on one cell at a time and answers when it is done.
class ScriptedRanks : public RankLink {
 public:
  /// The outcome of a cell in its rank.
  enum class Fate { baked, failed, refused, kills_the_process };
  /// The way in which a rank's answer arrives at rank 0.
  enum class Delivery { once, twice, malformed };

  ScriptedRanks(int ranks, std::uint64_t seed) : ranks_(std::size_t(ranks)), random_(seed) {}

  // The test sets these members. wait() calls `at`, which may change all of them.
  std::function<Fate(int rank, std::uint32_t job)> fate = [](int, std::uint32_t) { return Fate::baked; };
  std::function<Delivery(int rank, std::uint32_t job)> delivery = [](int, std::uint32_t) { return Delivery::once; };
  std::function<void(double now_s)> at = [](double) {};
  void stall(int rank) { ranks_[std::size_t(rank)].stalled = true; }
  void wake(int rank) { ranks_[std::size_t(rank)].stalled = false; }
  void kill_process(int rank);
  void report_device(int rank, const DeviceAnswer& device) { say(rank, tag_device, to_bytes(device)); }
  void ask_to_drain() { drain_asked_ = true; }

  // Results.
  /// Returns the number of orders that ranks accepted. Repeated attempts count as separate orders.
  std::size_t orders() const { return orders_; }
  /// Returns the number of cells that are in flight in a rank's bake process.
  std::size_t in_flight(int rank) const { return ranks_[std::size_t(rank)].hand.size(); }
  bool was_told_to_stop(int rank) const { return ranks_[std::size_t(rank)].stopped; }
  /// Returns the maximum time between two messages of rank 0 to this rank.
  double max_silence_s(int rank) const { return ranks_[std::size_t(rank)].max_silence_s; }

  int ranks() const override { return int(ranks_.size()); }
  double now_s() const override { return now_s_; }
  bool is_drain_requested() const override { return drain_asked_; }
  void send(int rank, Tag tag, std::vector<std::uint8_t> bytes) override;
  std::optional<Message> receive() override;
  void wait() override;

 private:
  struct Work {
    std::uint32_t job = 0, attempt = 0;
    double done_s = 0;
  };
  struct Rank {
    std::deque<Work> hand;
    std::deque<std::pair<Tag, std::vector<std::uint8_t>>> inbox;  ///< messages that a stalled rank has not read yet
    std::uint32_t deaths = 0;
    bool stalled = false, stopped = false;
    double shown_s = -10, heard_s = 0, max_silence_s = 0;
  };

  void handle(Rank& rank, Tag tag, const std::vector<std::uint8_t>& bytes);
  void work(int rank);
  void answer(int rank, const Work& work);
  void say(int rank, Tag tag, std::vector<std::uint8_t> bytes) { under_way_.push_back({rank, tag, std::move(bytes)}); }

  std::vector<Rank> ranks_;
  std::mt19937_64 random_;
  std::deque<Message> under_way_;
  double now_s_ = 0;
  bool drain_asked_ = false;
  std::size_t orders_ = 0;
};

}  // namespace gigabake
