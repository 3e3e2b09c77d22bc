/// Order of first dispatch: expensive cells first, then the others block by block, and near the end by cost again. A
/// worker's next cell is mostly a child of the same overview as its last cell, or shares tiles with it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "format/job/cell_job.h"
#include "scheduler/queue/index_set.h"

namespace gigabake {

/// The order in which jobs are first dispatched. Jobs form classes, in which costs differ by a factor of at most 1.5.
/// Cells in the class of twice the mean cost, or in a higher class, are expensive: they come first, class by class. The
/// others follow a Morton curve over the columns, so that neighbours on the curve are mostly spatial neighbours.
/// Near the end of the bake they are ordered by class, too, so that the workers finish at the same time.
///
/// The worker that gets the first child of an overview claims the others, and the children of all overviews that share
/// cells with it. Other workers get them only when no unclaimed cells are left. The worker then makes the overviews
/// from data in its memory; otherwise it would read the children's shards.
/// Exact   Deterministic: the same calls give the same answers on every machine.
/// Cost    32 bytes per job; a choice examines a constant number of cells.
class WorkOrder {
 public:
  /// `jobs` must outlive this object; initially all jobs are waiting.
  explicit WorkOrder(const std::vector<CellJob>& jobs);

  /// Returns the position of a job in the order by cost; lower is earlier. The position never changes.
  std::uint32_t rank(std::uint32_t job) const { return by_cost_.rank[job]; }
  std::uint32_t job(std::uint32_t rank) const { return by_cost_.job[rank]; }
  /// Returns the mean cost of a cell.
  std::uint64_t mean_cost() const { return mean_cost_; }

  /// Returns the job that `worker` gets next; it stays waiting until take(). Returns nullopt if no job waits. `last` is
  /// the worker's previous job. Prefers cells that `worker` has claimed, then unclaimed cells, in both cases near
  /// `last` on the curve. If there are none near `last`, or `last` is empty, choose() starts at a new position of the
  /// curve. New positions are spread evenly, so that workers do not soon reach the same tiles. Near the end of the bake
  /// (`is_ending`), prefers expensive cells.
  std::optional<std::uint32_t> choose(int worker, std::optional<std::uint32_t> last, bool is_ending);
  void take(std::uint32_t job);
  /// Records that `worker` gets the job. It claims the job's group of overviews, unless another worker has claimed it.
  void claim(std::uint32_t job, int worker);
  bool is_claimed_by_other(std::uint32_t job, int worker) const { return claim_of(job, worker) == Claim::others; }

 private:
  /// A permutation of jobs, and which of these wait.
  struct Sequence {
    std::vector<std::uint32_t> job;   ///< per position
    std::vector<std::uint32_t> rank;  ///< per job: its position, or `none`
    IndexSet waiting{0};

    void assign(std::vector<std::uint32_t> sorted_jobs, std::size_t all_jobs);
  };
  /// Positions of a sequence that follow the curve.
  struct Range {
    const Sequence& sequence;
    std::uint32_t begin, end;
  };
  enum class Claim : std::uint8_t { others, none, own };
  /// A waiting cell near a worker's last cell.
  struct Candidate {
    Claim claim = Claim::others;
    std::size_t shared_tiles = 0;
    std::uint64_t distance = 0;  ///< on the curve
    std::uint32_t job = 0;

    bool is_better_than(const Candidate& other) const;
  };
  static constexpr std::uint32_t none = 0xffffffffu;
  static constexpr int unclaimed = -1;

  void sort_by_cost(const std::vector<int>& class_of_job);
  void find_groups();
  Range class_of(std::uint32_t rank) const;
  Claim claim_of(std::uint32_t job, int worker) const;
  std::optional<Candidate> neighbour(const Range& range, std::uint32_t last, int worker) const;
  std::optional<std::uint32_t> unclaimed_start();
  std::uint32_t new_start(const Range& range);
  std::uint32_t choose_expensive(int worker) const;

  const std::vector<CellJob>& jobs_;
  std::uint64_t mean_cost_;
  std::vector<std::uint64_t> place_;      ///< per job: Morton code of the column
  Sequence by_cost_;                      ///< all jobs by class of cost, then by place
  Sequence ordinary_;                     ///< cells that are not expensive, by place
  std::vector<std::uint32_t> class_end_;  ///< end positions of the classes in by_cost_, ascending
  /// Per cell: its group of overviews that share cells, or `none`. A group has the number of its first overview.
  std::vector<std::uint32_t> group_;
  std::vector<int> claimed_by_;            ///< per group: a worker, or `unclaimed`
  std::vector<std::uint32_t> first_cell_;  ///< per group: position of its first cell in ordinary_, or `none`
  IndexSet unclaimed_{0};                  ///< groups that have ordinary cells
  std::uint32_t new_starts_ = 0;
};

}  // namespace gigabake
