#include "cluster/bake/scan_tiles.h"

#include <algorithm>
#include <chrono>
#include <deque>
#include <optional>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>
#include <variant>

#include "cluster/mpi/heartbeat.h"
#include "core/io/bytes.h"
#include "format/job/cell_job.h"

namespace gigabake {
namespace {

/// Max requests in flight per bake process. The process scans four tiles concurrently and must never wait for a
/// request.
constexpr std::size_t max_tiles_in_flight = 8;
constexpr int max_failures = 3;
constexpr std::chrono::milliseconds max_scan_wait{5};

/// The queue of tiles to request from a bake process.
class TileQueue {
 public:
  explicit TileQueue(const std::vector<std::uint32_t>& tiles) : waiting_(tiles.begin(), tiles.end()) {}

  bool is_empty() const { return waiting_.empty() && suspects_.empty(); }

  /// Returns the next tile to request, if any. A tile that needs an isolated retry is requested only if no other tile
  /// is in flight.
  std::optional<std::uint32_t> next(std::size_t in_flight) {
    if (alone_ && in_flight != 0) return std::nullopt;
    alone_ = !suspects_.empty();
    std::deque<std::uint32_t>& from = alone_ ? suspects_ : waiting_;
    if (from.empty() || in_flight >= (alone_ ? 1 : max_tiles_in_flight)) return std::nullopt;
    const std::uint32_t tile = from.front();
    from.pop_front();
    return tile;
  }

  /// Requeues the tiles of a process that never started.
  void take_back(const std::vector<std::uint32_t>& tiles) {
    waiting_.insert(waiting_.begin(), tiles.begin(), tiles.end());
    alone_ = false;
  }

  /// Requeues the tiles that were in flight when the process died, for isolated retries. If only one tile was in
  /// flight, the death counts as its failure. A tile with the max number of failures is returned instead.
  std::optional<std::uint32_t> put_back(const std::vector<std::uint32_t>& tiles) {
    if (tiles.size() == 1 && ++failures_[tiles[0]] >= max_failures) return tiles[0];
    suspects_.insert(suspects_.end(), tiles.begin(), tiles.end());
    return std::nullopt;
  }

 private:
  std::deque<std::uint32_t> waiting_, suspects_;
  std::unordered_map<std::uint32_t, int> failures_;
  bool alone_ = false;
};

TileScan given_up(std::uint32_t tile, const std::string& why) {
  TileScan scan;
  scan.tile = tile;
  scan.error = "terminates the process that reads it (tried " + std::to_string(max_failures) + " times): " + why;
  return scan;
}

/// Returns every `ranks`-th tile, starting at `rank`.
std::vector<std::uint32_t> tiles_of_rank(const std::vector<std::uint32_t>& tiles, int rank, int ranks) {
  std::vector<std::uint32_t> share;
  for (std::size_t i = std::size_t(rank); i < tiles.size(); i += std::size_t(ranks)) share.push_back(tiles[i]);
  return share;
}

/// Rank 0's collector of scan results from the other ranks.
class ScanCollector {
 public:
  ScanCollector(MpiSession& mpi, const std::vector<std::uint32_t>& tiles, double heartbeat_timeout_s,
                const ScanListener& listener)
      : mpi_(mpi), heartbeat_timeout_s_(heartbeat_timeout_s), listener_(listener), ranks_(std::size_t(mpi.ranks())) {
    for (int rank = 0; rank < mpi.ranks(); ++rank)
      ranks_[std::size_t(rank)] = {tiles_of_rank(tiles, rank, mpi.ranks()).size(), Clock::now()};
  }

  void collect() {
    while (const auto message = mpi_.poll()) {
      Rank& rank = ranks_[std::size_t(message->from)];
      rank.heard = Clock::now();
      if (message->tag == tag_stop) rank.missing = 0;
      if (message->tag == tag_died) listener_.died(message->from, {message->bytes.begin(), message->bytes.end()});
      if (message->tag != tag_scan) continue;
      scans_.push_back(scan_from_bytes(message->bytes));
      --rank.missing;
    }
    for (int rank = 1; rank < mpi_.ranks(); ++rank) expect_life(rank);
  }

  /// Stops the scan on the other ranks, and waits until none of their messages is pending.
  void stop(BakeProcess& process) {
    const auto is_busy = [](const Rank& r) { return r.missing != 0; };
    for (int rank = 1; rank < mpi_.ranks(); ++rank)
      if (is_busy(ranks_[std::size_t(rank)])) mpi_.send(rank, tag_stop, {});
    while (std::any_of(ranks_.begin() + 1, ranks_.end(), is_busy)) {
      collect();
      process.wait(max_scan_wait);
    }
  }

  std::vector<TileScan>& scans() { return scans_; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Rank {
    std::size_t missing = 0;
    Clock::time_point heard;
  };

  void expect_life(int rank) const {
    const Rank& r = ranks_[std::size_t(rank)];
    if (r.missing == 0 || std::chrono::duration<double>(Clock::now() - r.heard).count() < heartbeat_timeout_s_) return;
    throw RankLost("no message from rank " + std::to_string(rank) +
                   " while tiles were scanned; run the same command again, without its host");
  }

  MpiSession& mpi_;
  double heartbeat_timeout_s_;
  const ScanListener& listener_;
  std::vector<Rank> ranks_;
  std::vector<TileScan> scans_;
};

/// Sends every rank its tiles from rank 0; returns this rank's tiles.
std::vector<std::uint32_t> distribute_tiles(MpiSession& mpi, const std::vector<std::uint32_t>& tiles,
                                            const BakeProcess& process) {
  if (mpi.rank() == 0) {
    for (int rank = 1; rank < mpi.ranks(); ++rank) {
      ByteWriter writer;
      writer.put(tiles_of_rank(tiles, rank, mpi.ranks()));
      mpi.send(rank, tag_tiles, writer.take());
    }
    return tiles_of_rank(tiles, 0, mpi.ranks());
  }
  const auto start = std::chrono::steady_clock::now();
  while (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() < mpi.collective_timeout_s()) {
    if (const auto message = mpi.poll()) {
      std::vector<std::uint32_t> own;
      ByteReader(message->bytes, "tiles to scan").get(own);
      return own;
    }
    process.wait(max_scan_wait);
  }
  throw RankLost("no message from rank 0 before tiles were scanned; run the same command again");
}

}  // namespace

void scan_on_this_rank(BakeProcess& process, const std::vector<std::uint32_t>& tiles,
                       const std::function<void(TileScan)>& each, const std::function<void(const std::string&)>& died,
                       const std::function<bool()>& idle) {
  TileQueue queue(tiles);
  int failed_starts = 0;
  while (!queue.is_empty() || process.in_flight() != 0) {
    while (const auto tile = queue.next(process.in_flight())) process.scan(*tile);
    process.wait(max_scan_wait);
    while (auto event = process.poll()) {
      if (auto* scanned = std::get_if<BakeProcess::Scanned>(&*event)) each(std::move(scanned->scan));
      const auto* death = std::get_if<BakeProcess::Died>(&*event);
      if (death == nullptr) continue;
      failed_starts = death->has_started ? 0 : failed_starts + 1;
      if (failed_starts == max_failed_starts) throw_no_start(death->why);
      died(death->why);
      if (!death->has_started)
        queue.take_back(death->tiles);
      else if (const auto tile = queue.put_back(death->tiles))
        each(given_up(*tile, death->why));
    }
    if (!idle()) return;
  }
}

namespace {

/// Scans on every rank but 0. During a scan rank 0 sends only `tag_stop`.
void scan_for_master(MpiSession& mpi, BakeProcess& process, const std::vector<std::uint32_t>& tiles) {
  HeartbeatSender signs(mpi, process);
  scan_on_this_rank(
      process, tiles, [&](const TileScan& s) { mpi.send(0, tag_scan, to_bytes(s)); },
      [&](const std::string& why) {
        mpi.send(0, tag_died, {why.begin(), why.end()});
      },
      [&] {
        signs.show();
        if (const auto message = mpi.poll(); !message || message->tag != tag_stop) return true;
        mpi.send(0, tag_stop, {});
        return false;
      });
}

}  // namespace

std::vector<TileScan> scan_tiles(MpiSession& mpi, const std::vector<std::uint32_t>& tiles, BakeProcess& process,
                                 double heartbeat_timeout_s, const ScanListener& listener) {
  const std::vector<std::uint32_t> own = distribute_tiles(mpi, tiles, process);
  if (mpi.rank() != 0) {
    scan_for_master(mpi, process, own);
    return {};
  }
  ScanCollector collector(mpi, tiles, heartbeat_timeout_s, listener);
  const auto collect = [&] {
    collector.collect();
    return listener.scanned(collector.scans().size());
  };
  scan_on_this_rank(
      process, own, [&](TileScan s) { collector.scans().push_back(std::move(s)); },
      [&](const std::string& why) { listener.died(0, why); }, collect);
  bool goes_on = collect();
  for (; goes_on && collector.scans().size() < tiles.size(); goes_on = collect()) process.wait(max_scan_wait);
  if (!goes_on) collector.stop(process);
  return std::move(collector.scans());
}

}  // namespace gigabake
