/// Jobs for the overview levels above the cells: overviews, their children and their fingerprints.
///
/// An overview is a block of the lattice with at most 8³ children, cells or overviews, and has the three levels above
/// its children's. A surface crosses about 64 children of a block, so there is about one overview per 64 cells. Each
/// tile is below one chain of overviews. The last one, the root, has as many levels as remain.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "format/job/cell_job.h"
#include "scheduler/plan/plan.h"

namespace gigabake {

inline constexpr int max_levels_per_overview = 3;
/// Max log2 of a window's edge in voxels; larger scenes have several topmost overviews.
/// Range   The same as CellJob::cell_voxels.
inline constexpr int max_window_bits = 31;

/// Max log2 of the width of an overview's finest level. An overview also duplicates its children's coarsest levels up
/// to that width. Any level needed for an image is then in one file for at least about 64² pixels; above the first
/// overview level, for 256². It never duplicates the children's finest stored level. For cells of 512³ and more, all
/// overviews together are less than a hundredth of a scene.
inline constexpr int overview_width_bits_of_cells = 8, overview_width_bits_of_overviews = 10;

/// Appends overviews to jobs that are cells of one size, each after its children. A scene of one cell has none. Block
/// origins are aligned to the edge; the root's to half of it, so one root always covers the scene.
/// Exact   A function of the cells' windows and fingerprints.
void add_overviews(std::vector<CellJob>& jobs);

/// Returns the fingerprint of an overview. It covers the fingerprint of each child, zeros for a lost child, and the
/// overview's window and levels.
Hash128 overview_fingerprint(const CellJob& overview, std::span<const Hash128> children);

/// Tracks the available children and makes the overview jobs to dispatch.
class OverviewJobs {
 public:
  /// jobs must outlive it.
  explicit OverviewJobs(const std::vector<CellJob>& jobs);

  /// Records a job that was baked or is empty, in this bake or an earlier one.
  void is_done(const CellReport& report);
  /// Returns a job as a worker needs it. If children are lost, the overview is made from the others and gets a
  /// different fingerprint. A later bake with these children therefore makes it again.
  CellJob order(std::uint32_t job);

 private:
  enum class Child : std::uint8_t { lost, baked, empty };
  const std::vector<CellJob>& jobs_;
  std::vector<Child> child_;          ///< by job; lost until it is done
  std::vector<Hash128> fingerprint_;  ///< of overviews, from first_overview_ on: as last dispatched
  std::uint32_t first_overview_;
};

/// Returns false if the overview was made without some of its children.
bool is_made_of_all(const CellReport& overview, const CellJob& planned);

}  // namespace gigabake
