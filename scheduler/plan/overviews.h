/// Jobs for the overview levels above the cells: overviews, their children and their fingerprints.
///
/// An overview covers a block of the lattice with at most 8³ children, which are cells or overviews. It has the three
/// levels above its children's coarsest level. A surface crosses about 64 children of a block, so there is about one
/// overview per 64 cells. The last overview, the root, has as many levels as remain, at most three.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "format/job/cell_job.h"
#include "scheduler/plan/plan.h"

namespace gigabake {

inline constexpr int max_levels_per_overview = 3;
/// Max log2 of a window's edge in voxels; larger scenes have several topmost overviews.
/// Range   The edge fits into CellJob::cell_voxels.
inline constexpr int max_window_bits = 31;

/// Max log2 of an overview's width in voxels of its finest level, if its children are cells or overviews. An overview
/// duplicates its children's coarsest levels up to this width, but never the children's finest stored level. An image
/// then needs at most about one file per 64² pixels, or per 256² pixels above the first overview level. For cells of
/// 512³ and more, all overviews together have less than a hundredth of a scene's size.
inline constexpr int overview_width_bits_of_cells = 8, overview_width_bits_of_overviews = 10;

/// Appends the overviews to `jobs`, each after its children. `jobs` must be cells of one size; a single cell gets no
/// overview. The origin of a block is a multiple of the block's edge. The origin of the root is a multiple of half its
/// edge, so that one root covers the whole scene.
/// Exact   The overviews depend only on the cells' windows and fingerprints.
void add_overviews(std::vector<CellJob>& jobs);

/// Returns the fingerprint of an overview. It covers the fingerprint of each child, zeros for a lost child, and the
/// overview's window and levels.
Hash128 overview_fingerprint(const CellJob& overview, std::span<const Hash128> children);

/// A record of the available children, from which the overview jobs to dispatch are made.
class OverviewJobs {
 public:
  /// `jobs` must outlive this object.
  explicit OverviewJobs(const std::vector<CellJob>& jobs);

  /// Records a job that was baked or is empty, in this bake or an earlier one.
  void is_done(const CellReport& report);
  /// Returns a job with the members that a worker needs. If children are lost, the overview is made from its other
  /// children and gets a different fingerprint. A later bake that has the lost children therefore makes the overview
  /// again.
  CellJob order(std::uint32_t job);

 private:
  enum class Child : std::uint8_t { lost, baked, empty };
  const std::vector<CellJob>& jobs_;
  std::vector<Child> child_;          ///< per job; `lost` until the job is done
  std::vector<Hash128> fingerprint_;  ///< per overview, from job first_overview_ on: as last dispatched
  std::uint32_t first_overview_;
};

/// Returns false if the overview was made without some of its children.
bool is_made_of_all(const CellReport& overview, const CellJob& planned);

}  // namespace gigabake
