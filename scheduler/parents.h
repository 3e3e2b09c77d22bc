/// The levels above the cells as jobs: which parents there are, on whom each depends, and what it is ordered with.
///
/// A parent is a block of the lattice of 8³ children at most, cells or parents, and has the three levels above theirs:
/// a surface crosses some 64 children of a block, so there is one parent to 64 cells, and each tile lies below one
/// chain of them. The last one, the root, has as many levels as are missing.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "format/job/cell_job.h"
#include "scheduler/plan.h"

namespace gigabake {

inline constexpr int most_parent_levels = 3;
/// Where a scene is larger, parents end below a root. Range  of CellJob::cell_voxels.
inline constexpr int most_window_bits = 31;

/// A parent also copies its children's coarsest levels, until its finest is so many voxels wide, 2^bits: so whatever
/// level a picture needs, one file has it for some 64² pixels or more, and above the first parents for 256². Never the
/// finest level that they store; for cells of 512³ and more all parents together are below a hundredth of a scene.
inline constexpr int parent_width_bits_of_cells = 8, parent_width_bits_of_parents = 10;

/// Appends them to jobs that are cells of one size, each after its children; a scene of one cell has none. Blocks are
/// multiples of their edge, the root's of half of it: so every scene has one.
/// Exact  A function of the cells' windows and fingerprints.
void add_parents(std::vector<CellJob>& jobs);

/// The name of what a parent is made of: of each child its fingerprint, or zeros for one that is lost; and of which
/// levels it has.
Hash128 parent_fingerprint(const CellJob& parent, std::span<const Hash128> children);

/// Follows which children there are, for who hands their parents out.
class ParentOrders {
 public:
  /// jobs outlive it.
  explicit ParentOrders(const std::vector<CellJob>& jobs);

  /// It was baked or is empty, now or by an earlier bake.
  void is_done(const CellReport& report);
  /// A job as a worker needs it. A parent some of whose children are lost is made of the others, under another
  /// fingerprint: the next bake, which may have them, makes it anew.
  CellJob order(std::uint32_t job);

 private:
  enum class Child : std::uint8_t { lost, baked, empty };
  const std::vector<CellJob>& jobs_;
  std::vector<Child> child_;          ///< by job; lost until it is done
  std::vector<Hash128> fingerprint_;  ///< of parents, from first_parent_ on: as ordered last
  std::uint32_t first_parent_;
};

/// What the scene says of a parent that was made without some of its children.
bool is_made_of_all(const CellReport& parent, const CellJob& planned);

}  // namespace gigabake
