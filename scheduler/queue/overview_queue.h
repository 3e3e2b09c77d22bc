/// Queue of overviews that were never dispatched: some wait for children, the others are ready.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "format/job/cell_job.h"

namespace gigabake {

/// Queue of overviews.
/// Exact   Deterministic: the same calls give the same answers.
/// Cost    8 bytes per job and per child. A call visits the overviews of one job, or the ready overviews.
class OverviewQueue {
 public:
  /// `jobs` must have all overviews after all cells.
  explicit OverviewQueue(const std::vector<CellJob>& jobs);

  /// Records that the job is done or quarantined; call it once per job. `worker` is the worker that finished the job,
  /// if any.
  void settled(std::uint32_t job, std::optional<int> worker);
  /// Returns an overview that is ready; it stays queued until take(). Prefers an overview whose last child was finished
  /// by `worker`.
  std::optional<std::uint32_t> choose(int worker) const;
  /// Removes an overview, ready or not, that was dispatched or is already done.
  void take(std::uint32_t overview);
  /// Returns the number of overviews that wait for children.
  std::size_t waiting() const { return waiting_; }

 private:
  struct Ready {
    std::uint32_t overview;
    std::optional<int> worker;
  };
  static constexpr std::uint32_t taken = 0xffffffffu;

  std::uint32_t first_overview_;
  std::vector<std::uint32_t> missing_;                      ///< per overview: number of unsettled children, or `taken`
  std::vector<std::uint32_t> overviews_begin_, overviews_;  ///< per job: index of its first overview in overviews_
  std::vector<Ready> ready_;                                ///< in the order in which they became ready
  std::size_t waiting_ = 0;
};

}  // namespace gigabake
