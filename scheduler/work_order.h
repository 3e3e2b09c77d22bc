/// The order in which cells are handed out for the first time: the costliest first, and among cells of about that cost
/// the one whose tiles the worker has just read.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "format/job/cell_job.h"
#include "scheduler/rank_set.h"

namespace gigabake {

/// Cells of one cost class differ by less than half in cost; class by class, the costliest first. Within a class cells
/// follow a Morton curve over the columns, so that neighbours on the curve are mostly neighbours on the ground.
/// Exact  A value: the same calls give the same answers, on every machine.
/// Cost   16 bytes a job; a choice looks at a handful of cells, however many there are.
class WorkOrder {
 public:
  /// jobs outlive it; all of them wait.
  explicit WorkOrder(const std::vector<CellJob>& jobs);

  /// The place of a job in the whole order: lower is earlier. Never changes.
  std::uint32_t rank(std::uint32_t job) const { return rank_[job]; }
  std::uint32_t job(std::uint32_t rank) const { return job_[rank]; }

  /// The job to hand out next, which waits until take(); nothing when none waits. last: what the worker took before.
  /// Where nothing near it that waits shares a tile with it, and where there is no last, the worker starts in a place
  /// of its own, far from the others, so that none soon walks into another's tiles.
  std::optional<std::uint32_t> choose(std::optional<std::uint32_t> last);
  void take(std::uint32_t job) { waiting_.erase(rank_[job]); }

 private:
  struct Class {
    std::uint32_t begin, end;  ///< ranks
  };
  Class class_of(std::uint32_t rank) const;
  std::optional<std::uint32_t> neighbour(const Class& c, std::uint32_t last) const;
  std::uint32_t new_place(const Class& c);

  const std::vector<CellJob>& jobs_;
  std::vector<std::uint32_t> job_, rank_;
  std::vector<std::uint64_t> place_;      ///< by rank: where on the curve
  std::vector<std::uint32_t> class_end_;  ///< ascending
  RankSet waiting_;
  std::uint32_t new_places_ = 0;
};

}  // namespace gigabake
