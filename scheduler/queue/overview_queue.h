/// Queue of overviews that were never dispatched: some wait for children, the others are ready.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "format/job/cell_job.h"

namespace gigabake {

/// Queue of overviews.
/// Exact   Deterministic: the same calls give the same answers.
/// Cost    8 bytes per job and per child. A call visits the overviews of one job, or the ready overviews; forget()
///         visits all.
class OverviewQueue {
 public:
  /// `jobs` must have all overviews after all cells.
  explicit OverviewQueue(const std::vector<CellJob>& jobs);

  /// Records that the job is done or quarantined; call it once per job. `worker` is the worker that finished the job,
  /// if any.
  void settled(std::uint32_t job, std::optional<int> worker);
  /// Records that the worker's memory is lost, so that its overviews are ready for all workers.
  void forget(int worker);
  /// Returns an overview that is ready for `worker`; it stays queued until take(). An overview is ready only for the
  /// worker that finished more than half of its children, because these are in that worker's memory. If no worker
  /// finished more than half, it is ready for one of them, or for all if there are none.
  std::optional<std::uint32_t> choose(int worker) const;
  /// Removes an overview, ready or not, that was dispatched or is already done.
  void take(std::uint32_t overview);
  /// Returns the number of overviews that wait for children.
  std::size_t waiting() const { return waiting_; }

 private:
  /// A vote for the worker that finished most children (Boyer and Moore, MJRTY, 1991). It finds a worker that finished
  /// more than half of them, if one did.
  struct Vote {
    int worker = 0;
    std::uint32_t lead = 0;  ///< 0: no worker leads
  };
  static constexpr std::uint32_t taken = 0xffffffffu;

  std::uint32_t first_overview_;
  std::vector<std::uint32_t> missing_;                      ///< per overview: number of unsettled children, or `taken`
  std::vector<std::uint32_t> overviews_begin_, overviews_;  ///< per job: index of its first overview in overviews_
  std::vector<Vote> votes_;                                 ///< per overview
  std::vector<std::uint32_t> ready_;                        ///< in the order in which they became ready
  std::size_t waiting_ = 0;
};

}  // namespace gigabake
