#include "bench/schedule_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gigabake::bench {
namespace {

constexpr std::uint32_t columns_of_tile = 10;

std::uint64_t mixed(std::uint64_t x) {  // splitmix64
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ x >> 27) * 0x94d049bb133111ebull;
  return x ^ x >> 31;
}

/// Returns a log-normal number with mean 1.
double log_normal(double sigma, std::uint64_t seed, std::uint64_t index) {
  const double radius = std::sqrt(-2 * std::log(1 - uniform(seed, 2 * index)));
  const double normal = radius * std::cos(2 * std::numbers::pi * uniform(seed, 2 * index + 1));
  return std::exp(sigma * normal - sigma * sigma / 2);
}

/// Returns the number of tiles along one axis that contain a column: 1, or 2 if the previous tile ends in the column.
std::uint32_t tiles_over(std::uint32_t column) { return column > 0 && column % columns_of_tile == 0 ? 2 : 1; }

/// Returns a column of a hilly surface with one cell per column.
ColumnExtent column_at(std::uint32_t x, std::uint32_t y, std::uint32_t index, std::uint64_t seed) {
  const double triangles = mean_triangles * log_normal(sigma_of_triangles, seed, index);
  const auto z = std::int64_t(2000 * std::sin(0.01 * x) * std::cos(0.013 * y));
  return {x, y, z, z + 300, std::uint64_t(std::ceil(triangles / (tiles_over(x) * tiles_over(y))))};
}

}  // namespace

double uniform(std::uint64_t seed, std::uint64_t index) { return double(mixed(mixed(seed) ^ index) >> 11) * 0x1p-53; }

std::vector<TileScan> terrain_scans(std::uint32_t cells, std::uint64_t seed) {
  const auto side = std::uint32_t(std::ceil(std::sqrt(double(cells))));
  const std::uint32_t tiles = (side + columns_of_tile - 1) / columns_of_tile;
  std::vector<TileScan> scans(std::size_t(tiles) * tiles);
  for (std::uint32_t t = 0; t < scans.size(); ++t) {
    TileScan& s = scans[t];
    s.tile = t;
    s.source = {mixed(t), mixed(~std::uint64_t(t))};
    const std::uint32_t west = t % tiles * columns_of_tile, south = t / tiles * columns_of_tile;
    for (std::uint32_t x = west; x <= std::min(west + columns_of_tile, side - 1); ++x)
      for (std::uint32_t y = south; y <= south + columns_of_tile && y * side + x < cells; ++y) {
        s.columns.push_back(column_at(x, y, y * side + x, seed));
        s.triangles += s.columns.back().triangles;
      }
  }
  return scans;
}

StageTimes true_times(const CellJob& job, std::uint64_t seed) {
  const double seconds =
      seconds_per_triangle * double(job.triangles) * log_normal(sigma_of_seconds, seed ^ 0x7365636f6e6473, job.id);
  return {share_of_read * seconds, share_of_kernels * seconds, share_of_write * seconds};
}

}  // namespace gigabake::bench
