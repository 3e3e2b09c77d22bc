#include "scheduler/plan/size_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace gigabake {
namespace {

constexpr double usual_levels = 4.0 / 3;  // each coarser level of a surface has a quarter of the voxels
constexpr double usual_bytes_per_voxel = 2, usual_bytes_per_cell = 24000;

std::uint64_t rounded(double v) { return std::uint64_t(std::llround(std::clamp(v, 0.0, 9e18))); }

/// Sums over pieces.
struct Sums {
  double projected_voxels = 0, voxels_lod0 = 0, voxels = 0, level_bytes = 0, shard_bytes = 0, cells = 0;
  double read_s = 0, work_s = 0;
  explicit Sums(const std::vector<BakedPiece>& pieces) {
    for (const BakedPiece& p : pieces) {
      projected_voxels += p.projected_voxels;
      voxels_lod0 += double(p.voxels_lod0);
      voxels += double(p.voxels);
      level_bytes += double(p.level_bytes);
      shard_bytes += double(p.shard_bytes);
      cells += double(p.cells);
      read_s += p.read_s;
      work_s += p.kernel_s + p.write_s;
    }
  }
};

/// Mean number of lod-0 voxels per projected voxel, over pieces with projected voxels.
struct Ratio {
  double mean = 1, error = 0;  ///< error: standard error of the mean
  explicit Ratio(const std::vector<BakedPiece>& pieces) {
    double sum = 0, squares = 0, n = 0;
    for (const BakedPiece& p : pieces) {
      if (p.projected_voxels <= 0) continue;
      const double r = double(p.voxels_lod0) / p.projected_voxels;
      sum += r;
      squares += r * r;
      n += 1;
    }
    if (n == 0) return;
    mean = sum / n;
    if (n > 1) error = std::sqrt(std::max(0.0, squares / n - mean * mean) / (n - 1));
  }
};

/// Returns the ratio of all triangles to the triangles of the tiles that were read for the pieces.
double reads_left(const SampledScene& scene, const std::vector<BakedPiece>& pieces) {
  std::set<std::uint32_t> tiles;
  for (const BakedPiece& p : pieces) tiles.insert(p.tile);
  double read = 0, all = 0;
  for (std::uint32_t t = 0; t < scene.tile_triangles.size(); ++t) {
    all += double(scene.tile_triangles[t]);
    if (tiles.count(t) != 0) read += double(scene.tile_triangles[t]);
  }
  return read > 0 ? all / read : 1;
}

/// Returns the estimated bake time. Assumes that stages overlap as much as in the sample.
double bake_seconds(const SampledScene& scene, const BakedSample& sample, const Sums& sums, double voxels) {
  const double overlap = sample.wall_s / std::max(1e-9, sums.read_s + sums.work_s);
  const double work_s = sums.work_s * voxels / std::max(1.0, sums.voxels);
  return overlap * (sums.read_s * reads_left(scene, sample.pieces) + work_s) / std::max(1, scene.ranks);
}

}  // namespace

SizeEstimate estimate_size(const SampledScene& scene, const BakedSample& sample) {
  const Sums sums(sample.pieces);
  const Ratio ratio(sample.pieces);
  const double rest = std::max(0.0, scene.projected_voxels - sums.projected_voxels);
  const double voxels_lod0 = sums.voxels_lod0 + rest * ratio.mean;
  const bool has_voxels = sums.voxels > 0;
  const double voxels = voxels_lod0 * (has_voxels ? sums.voxels / sums.voxels_lod0 : usual_levels);
  const double per_voxel = has_voxels ? sums.level_bytes / sums.voxels : usual_bytes_per_voxel;
  const double per_cell = has_voxels ? (sums.shard_bytes - sums.level_bytes) / sums.cells : usual_bytes_per_cell;
  SizeEstimate e;
  e.voxels_lod0 = rounded(voxels_lod0);
  e.voxels = rounded(voxels);
  e.bytes = rounded(voxels * per_voxel + double(scene.cells) * per_cell);
  if (has_voxels) e.bake_s = bake_seconds(scene, sample, sums, voxels);
  e.voxels_error = voxels_lod0 > 0 ? rest * ratio.error / voxels_lod0 : 0;
  e.share = scene.projected_voxels > 0 ? std::min(1.0, sums.projected_voxels / scene.projected_voxels) : 0;
  return e;
}

SizeEstimate scaled(const SizeEstimate& estimate, double scale) {
  SizeEstimate e = estimate;
  e.voxels_lod0 = rounded(double(e.voxels_lod0) * scale);
  e.voxels = rounded(double(e.voxels) * scale);
  e.bytes = rounded(double(e.bytes) * scale);
  if (e.bake_s) *e.bake_s *= scale;
  e.share = 0;
  return e;
}

double round_size(double size) {
  constexpr std::array<double, 10> steps{1, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10};
  const double decade = std::pow(10.0, std::floor(std::log10(size)));
  const double m = size / decade;
  const auto distance = [m](double step) { return std::fabs(std::log(m / step)); };
  return decade *
         *std::min_element(steps.begin(), steps.end(), [&](double a, double b) { return distance(a) < distance(b); });
}

}  // namespace gigabake
