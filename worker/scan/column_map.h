/// Accumulates the columns that a tile's triangles overlap.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "format/job/tile_scan.h"

namespace gigabake {

inline constexpr std::uint64_t max_columns = std::uint64_t(1) << 21;
/// Max (column, triangle) pairs per thread, so that a hostile tile fails within seconds.
inline constexpr std::uint64_t max_visits = std::uint64_t(1) << 28;

struct ColumnKey {
  std::int64_t x, y;
  friend bool operator==(const ColumnKey&, const ColumnKey&) = default;
};

struct ColumnKeyHash {
  std::size_t operator()(const ColumnKey& k) const {
    return std::size_t(std::uint64_t(k.x) * 0x9e3779b97f4a7c15ull ^
                       std::rotl(std::uint64_t(k.y) * 0xc2b2ae3d27d4eb4full, 32));
  }
};

/// Merges another extent of the same column into `column`. The sum of `projected_voxels` saturates.
inline void unite_into(ColumnExtent& column, const ColumnExtent& other) {
  column.z_min = std::min(column.z_min, other.z_min);
  column.z_end = std::max(column.z_end, other.z_end);
  column.triangles += other.triangles;
  const std::uint64_t room = UINT64_MAX - column.projected_voxels;
  column.projected_voxels += std::min(room, other.projected_voxels);
}

/// The columns that one thread has found. The last column is cached, because neighbouring triangles mostly lie in the
/// same column.
class ColumnMap {
 public:
  void add(const ColumnExtent& c) {
    if (last_ == nullptr || last_->column_x != c.column_x || last_->column_y != c.column_y) {
      const ColumnExtent empty{c.column_x, c.column_y, c.z_min, c.z_end};
      last_ = &columns_.try_emplace(ColumnKey{c.column_x, c.column_y}, empty).first->second;
    }
    unite_into(*last_, c);
    ++visits_;
  }
  bool is_too_wide() const { return columns_.size() > max_columns || visits_ > max_visits; }
  const auto& columns() const { return columns_; }

 private:
  std::unordered_map<ColumnKey, ColumnExtent, ColumnKeyHash> columns_;
  ColumnExtent* last_ = nullptr;
  std::uint64_t visits_ = 0;
};

/// Sorts the extents by column, and merges extents of the same column that several threads have found.
inline void unite_columns(std::vector<ColumnExtent>& columns) {
  std::sort(columns.begin(), columns.end(), [](const ColumnExtent& a, const ColumnExtent& b) {
    return std::pair(a.column_x, a.column_y) < std::pair(b.column_x, b.column_y);
  });
  std::size_t kept = 0;
  for (const ColumnExtent& c : columns) {
    if (kept != 0 && columns[kept - 1].column_x == c.column_x && columns[kept - 1].column_y == c.column_y)
      unite_into(columns[kept - 1], c);
    else
      columns[kept++] = c;
  }
  columns.resize(kept);
}

}  // namespace gigabake
