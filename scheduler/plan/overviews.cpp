#include "scheduler/plan/overviews.h"

#define XXH_INLINE_ALL
#include <algorithm>
#include <bit>
#include <map>
#include <xxhash.h>

#include "core/math/box3.h"
#include "core/octree/brick.h"

namespace gigabake {
namespace {

std::int64_t floor_multiple(std::int64_t v, std::int64_t of) {
  const std::int64_t rest = v % of;
  return v - (rest < 0 ? rest + of : rest);
}

/// Returns the bounding box of the jobs' windows on the lattice.
Box3i64 bounds_of(std::span<const CellJob> jobs) {
  Box3i64 bounds;
  for (const CellJob& job : jobs) bounds = hull(bounds, Box3i64::cube(job.lattice_min, job.cell_voxels));
  return bounds;
}

/// Returns a window with an edge of 2^bits voxels. Its lowest corner is the largest multiple of half the edge at or
/// below `min` on each axis.
Box3i64 window_at(const Vec3i64& min, int bits) {
  return Box3i64::cube(min >> (bits - 1) << (bits - 1), std::int64_t(1) << bits);
}

/// Returns the finest lattice level that an overview with an edge of 2^bits voxels may duplicate. `child_lod` is the
/// finest level that its children store.
int finest_copy(int bits, int child_lod) {
  const int width = child_lod == 0 ? overview_width_bits_of_cells : overview_width_bits_of_overviews;
  return std::max(bits - width, child_lod + 1);
}

/// Makes an overview job. `child_lod` is the finest level that its children store.
CellJob overview_of(const Vec3i64& min, int child_bits, int child_lod, int levels) {
  CellJob job;
  const std::int64_t child = std::int64_t(1) << child_bits;
  const int own_lod = child_bits - std::countr_zero(unsigned(brick_edge)) + 1;
  job.first_lod = std::uint32_t(std::min(own_lod, finest_copy(child_bits + levels, child_lod)));
  job.copied_lods = std::uint32_t(own_lod) - job.first_lod;
  job.cell_voxels = std::uint32_t(1) << (child_bits + levels);
  job.lattice_min = min;
  job.name = "p" + std::to_string(own_lod);
  for (const std::int64_t x : min) job.name += "_" + std::to_string(floor_multiple(x, child) / child);
  return job;
}

/// A builder of the overviews above jobs [first, jobs.size()). The windows of these jobs have an edge of 2^bits voxels.
/// add() returns true if no further overview level follows.
class OverviewLevelBuilder {
 public:
  OverviewLevelBuilder(std::vector<CellJob>& jobs, std::size_t first, int bits)
      : jobs_(jobs), first_(first), bits_(bits), child_lod_(int(jobs[first].first_lod)) {}

  bool add() {
    const Box3i64 bounds = bounds_of(std::span<const CellJob>(jobs_).subspan(first_));
    for (int levels = 1; levels <= max_levels_per_overview && bits_ + levels <= max_window_bits; ++levels)
      if (const Box3i64 window = window_at(bounds.min, bits_ + levels); hull(window, bounds) == window) {
        add_root(window.min, levels);
        return true;
      }
    if (bits_ + max_levels_per_overview > max_window_bits) return true;
    add_blocks();
    return false;
  }

 private:
  void add_root(const Vec3i64& min, int levels) {
    CellJob root = overview_of(min, bits_, child_lod_, levels);
    for (std::size_t i = first_; i < jobs_.size(); ++i) root.children.push_back(std::uint32_t(i));
    jobs_.push_back(std::move(root));
  }

  /// Adds one overview per block. A cell may extend into the block above its own, because stacks of cells begin at any
  /// voxel of their coarsest level.
  void add_blocks() {
    const std::int64_t edge = std::int64_t(1) << (bits_ + max_levels_per_overview), child = std::int64_t(1) << bits_;
    std::map<Vec3i64, std::vector<std::uint32_t>> blocks;
    for (std::size_t i = first_; i < jobs_.size(); ++i) {
      const Vec3i64& min = jobs_[i].lattice_min;
      Vec3i64 block{floor_multiple(min[2], edge), floor_multiple(min[1], edge), floor_multiple(min[0], edge)};
      for (; block[0] < min[2] + child; block[0] += edge) blocks[block].push_back(std::uint32_t(i));
    }
    for (auto& [zyx, children] : blocks) {
      jobs_.push_back(overview_of({zyx[2], zyx[1], zyx[0]}, bits_, child_lod_, max_levels_per_overview));
      jobs_.back().children = std::move(children);
    }
  }

  std::vector<CellJob>& jobs_;
  const std::size_t first_;
  const int bits_, child_lod_;
};

}  // namespace

Hash128 overview_fingerprint(const CellJob& overview, std::span<const Hash128> children) {
  XXH3_state_t state;
  XXH3_128bits_reset(&state);
  XXH3_128bits_update(&state, &overview.lattice_min, sizeof overview.lattice_min);
  XXH3_128bits_update(&state, &overview.cell_voxels, sizeof overview.cell_voxels);
  XXH3_128bits_update(&state, &overview.first_lod, sizeof overview.first_lod);
  XXH3_128bits_update(&state, &overview.copied_lods, sizeof overview.copied_lods);
  XXH3_128bits_update(&state, children.data(), children.size_bytes());
  const XXH128_hash_t h = XXH3_128bits_digest(&state);
  return {h.low64, h.high64};
}

void add_overviews(std::vector<CellJob>& jobs) {
  if (jobs.size() < 2) return;
  const std::size_t cells = jobs.size();
  int bits = std::countr_zero(jobs[0].cell_voxels);
  for (std::size_t first = 0, end = cells; !OverviewLevelBuilder(jobs, first, bits).add();
       bits += max_levels_per_overview) {
    first = end;
    end = jobs.size();
  }
  for (std::size_t i = cells; i < jobs.size(); ++i) {
    std::vector<Hash128> of_children;
    for (const std::uint32_t child : jobs[i].children) of_children.push_back(jobs[child].fingerprint);
    for (const std::uint32_t child : jobs[i].children) jobs[child].kept_lod = jobs[i].first_lod;
    jobs[i].id = std::uint32_t(i);
    jobs[i].fingerprint = overview_fingerprint(jobs[i], of_children);
  }
}

OverviewJobs::OverviewJobs(const std::vector<CellJob>& jobs)
    : jobs_(jobs),
      child_(jobs.size(), Child::lost),
      first_overview_(std::uint32_t(std::find_if(jobs.begin(), jobs.end(), is_overview) - jobs.begin())) {
  for (std::size_t i = first_overview_; i < jobs.size(); ++i) fingerprint_.push_back(jobs[i].fingerprint);
}

void OverviewJobs::is_done(const CellReport& report) {
  child_.at(report.id) = report.outcome == CellOutcome::baked ? Child::baked : Child::empty;
}

CellJob OverviewJobs::order(std::uint32_t id) {
  CellJob job = jobs_.at(id);
  if (!is_overview(job)) return job;
  std::vector<Hash128> of_children;
  for (const std::uint32_t child : job.children) {
    const Hash128& fingerprint =
        child < first_overview_ ? jobs_[child].fingerprint : fingerprint_[child - first_overview_];
    of_children.push_back(child_[child] == Child::lost ? Hash128{} : fingerprint);
    if (child_[child] == Child::baked) job.child_files.push_back(shard_file(jobs_[child].name, fingerprint));
  }
  job.fingerprint = fingerprint_[id - first_overview_] = overview_fingerprint(job, of_children);
  return job;
}

bool is_made_of_all(const CellReport& overview, const CellJob& planned) {
  return overview.outcome != CellOutcome::baked || overview.cell.fingerprint == planned.fingerprint;
}

}  // namespace gigabake
