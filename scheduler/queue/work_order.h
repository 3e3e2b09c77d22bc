/// Order of first dispatch: the most expensive cells first, and among cells of similar cost those whose tiles the
/// worker has just read.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "format/job/cell_job.h"
#include "scheduler/queue/index_set.h"

namespace gigabake {

/// Costs within one cost class differ by less than half. Classes are ordered from expensive to cheap. Cells of a class
/// follow a Morton curve over the columns, so that neighbours on the curve are mostly spatial neighbours.
/// Exact   A plain value: the same calls give the same answers on every machine.
/// Cost    16 bytes per job; a choice examines a constant number of cells.
class WorkOrder {
 public:
  /// jobs must outlive it; initially all are waiting.
  explicit WorkOrder(const std::vector<CellJob>& jobs);

  /// Returns the position of a job in the order; lower is earlier. Never changes.
  std::uint32_t rank(std::uint32_t job) const { return rank_[job]; }
  std::uint32_t job(std::uint32_t rank) const { return job_[rank]; }

  /// Returns the job to dispatch next; it stays waiting until take(). Returns nullopt if none waits. last: the worker's
  /// previous job. If there is none, or no waiting job near it shares a tile with it, the worker starts at a new place.
  /// The new place is far from the others, so that workers do not soon meet in the same tiles.
  std::optional<std::uint32_t> choose(std::optional<std::uint32_t> last);
  void take(std::uint32_t job) { waiting_.erase(rank_[job]); }

 private:
  struct Class {
    std::uint32_t begin, end;  ///< positions in the order
  };
  Class class_of(std::uint32_t rank) const;
  std::optional<std::uint32_t> neighbour(const Class& c, std::uint32_t last) const;
  std::uint32_t new_start(const Class& c);

  const std::vector<CellJob>& jobs_;
  std::vector<std::uint32_t> job_, rank_;
  std::vector<std::uint64_t> place_;      ///< by position: Morton code
  std::vector<std::uint32_t> class_end_;  ///< ascending
  IndexSet waiting_;
  std::uint32_t new_starts_ = 0;
};

}  // namespace gigabake
