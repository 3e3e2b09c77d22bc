#include "scheduler/plan/piece_order.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace gigabake {
namespace {

constexpr std::uint32_t min_piece_voxels = 64;
// Voxels of a surface per voxel of horizontal area; above 1 because of the slope
constexpr double voxels_of_a_sheet = 1.5;

}  // namespace

/// Sorts the indices by descending u^(1/weight), where u is a random number in (0, 1) per index.
/// Source  Efraimidis, Spirakis 2006.
std::vector<std::uint32_t> weighted_order(const std::vector<std::uint64_t>& weights, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<std::pair<double, std::uint32_t>> keys;
  for (std::uint32_t i = 0; i < weights.size(); ++i) {
    const double u = (double(random() >> 11) + 0.5) * 0x1p-53;
    if (weights[i] > 0) keys.emplace_back(-std::log(u) / double(weights[i]), i);
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> order;
  for (const auto& [key, index] : keys) order.push_back(index);
  return order;
}

std::vector<Piece> piece_order(const std::vector<TileScan>& scans, bool all_tiles, std::uint64_t seed) {
  std::vector<std::vector<Piece>> lists(all_tiles ? 1 : scans.size());
  for (std::size_t i = 0; i < scans.size(); ++i)
    for (const ColumnExtent& c : scans[i].columns) lists[all_tiles ? 0 : i].push_back({scans[i].tile, c});
  std::vector<Piece> pieces;
  std::vector<std::vector<std::uint32_t>> orders;
  std::size_t maximum = 0;
  for (const std::vector<Piece>& list : lists) {
    std::vector<std::uint64_t> weights;
    for (const Piece& piece : list) weights.push_back(piece.column.projected_voxels);
    orders.push_back(weighted_order(weights, ++seed));
    maximum = std::max(maximum, orders.back().size());
  }
  for (std::size_t turn = 0; turn < maximum; ++turn)
    for (std::size_t i = 0; i < lists.size(); ++i)
      if (turn < orders[i].size()) pieces.push_back(lists[i][orders[i][turn]]);
  return pieces;
}

std::uint32_t piece_voxels(double voxels, std::uint32_t cell_voxels) {
  std::uint32_t edge = cell_voxels;
  while (edge > min_piece_voxels && voxels_of_a_sheet * double(edge) * double(edge) > voxels) edge /= 2;
  return edge;
}

}  // namespace gigabake
