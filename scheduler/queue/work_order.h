/// Order of first dispatch: the most expensive cells first, and among cells of similar cost first the cells whose tiles
/// the worker has just read.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "format/job/cell_job.h"
#include "scheduler/queue/index_set.h"

namespace gigabake {

/// The order in which jobs are first dispatched, by classes of cost from expensive to cheap. The costs in a class
/// differ by a factor of at most 1.5. Cells of a class follow a Morton curve over the columns, so that neighbours on
/// the curve are mostly spatial neighbours.
/// Exact   Deterministic: the same calls give the same answers on every machine.
/// Cost    16 bytes per job; a choice examines a constant number of cells.
class WorkOrder {
 public:
  /// `jobs` must outlive this object; initially all jobs are waiting.
  explicit WorkOrder(const std::vector<CellJob>& jobs);

  /// Returns the position of a job in the order; lower is earlier. The position never changes.
  std::uint32_t rank(std::uint32_t job) const { return rank_[job]; }
  std::uint32_t job(std::uint32_t rank) const { return job_[rank]; }

  /// Returns the job to dispatch next; it stays waiting until take(). Returns nullopt if no job waits. `last` is the
  /// worker's previous job. The result is a waiting job that is near `last` on the curve and shares a tile with it. If
  /// no examined job shares a tile, or `last` is empty, choose() starts at a new position of the curve. New positions
  /// are spread evenly, so that workers do not soon reach the same tiles.
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
  std::vector<std::uint64_t> place_;      ///< per position in the order: Morton code of the column
  std::vector<std::uint32_t> class_end_;  ///< end positions of the classes, ascending
  IndexSet waiting_;
  std::uint32_t new_starts_ = 0;
};

}  // namespace gigabake
