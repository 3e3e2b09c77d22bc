#include "format/shard/columns/level_differences.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstring>
#include <numeric>

namespace gigabake {
namespace {

constexpr std::size_t bricks_per_range = 2048, max_row_bytes = 3;

}  // namespace

LevelDifferences::LevelDifferences(const BrickLevel& level, const BrickLevel* above, std::vector<BrickParent> parents,
                                   bool has_coverage, const ThreadPool& pool)
    : level_(level),
      above_{above, 0},
      parents_(std::move(parents)),
      is_dense_(any_brick([this](std::size_t b) { return has_voxel_without_parent(b); }, pool)),
      is_complete_(has_coverage && any_brick([this](std::size_t b) { return requires_all_coverages_of(b); }, pool)),
      first_children_(parents_.size() + 1),
      first_coverage_(parents_.size() + 1) {
  count_rows(has_coverage, pool);
}

/// Returns whether `test` is true for a brick.
template <class Test>
bool LevelDifferences::any_brick(const Test& test, const ThreadPool& pool) const {
  std::atomic<bool> found{false};
  pool.parallel_for(bricks(), bricks_per_range, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t b = begin; b < end && !found; ++b)
      if (test(b)) found = true;
  });
  return found;
}

bool LevelDifferences::has_voxel_without_parent(std::size_t brick) const {
  if (parents_[brick].kind != BrickParent::brick) return false;
  const std::uint64_t there = groups_with_parent_of(brick);
  const BrickCodes codes = codes_of(mask_of(brick));
  bool found = false;
  for (unsigned group = 0; group < groups_per_brick; ++group)
    found = found || ((there >> group & 1) == 0 && children_of_group(codes[group / 8], group) != 0);
  return found;
}

bool LevelDifferences::requires_all_coverages_of(std::size_t brick) const {
  bool found = false;
  for (std::size_t v = level_.first[brick]; v < level_.first[brick + 1]; ++v)
    found = found || requires_all_coverages(coverage_of(v));
  return found;
}

/// Returns the number of voxels of a brick that have a row in the column `facing`.
std::uint32_t LevelDifferences::count_coverages(std::size_t brick) const {
  std::uint32_t count = 0;
  for (std::size_t v = level_.first[brick]; v < level_.first[brick + 1]; ++v)
    count += stores_coverage(coverage_of(v)[directional_coverage_plane], is_complete_) ? 1 : 0;
  return count;
}

void LevelDifferences::count_rows(bool has_coverage, const ThreadPool& pool) {
  pool.parallel_for(bricks(), bricks_per_range, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t b = begin; b < end; ++b) {
      first_children_[b + 1] = children_rows(parents_[b].kind, groups_with_parent_of(b), is_dense_);
      if (has_coverage) first_coverage_[b + 1] = count_coverages(b);
    }
  });
  std::partial_sum(first_children_.begin(), first_children_.end(), first_children_.begin());
  std::partial_sum(first_coverage_.begin(), first_coverage_.end(), first_coverage_.begin());
}

std::uint64_t LevelDifferences::rows(LevelColumn column) const {
  switch (column) {
    case LevelColumn::first:
      return (bricks() + bricks_per_start - 1) / bricks_per_start + 1;
    case LevelColumn::children:
      return first_children_.back();
    case LevelColumn::facing:
      return first_coverage_.back();
    default:
      return level_.first.back();
  }
}

/// Collects rows brick by brick; `first` has the first row of each brick. write(brick, to) must write all rows of a
/// brick. A brick that `to` covers only partly is written to a temporary buffer first.
template <class Write>
void LevelDifferences::collect_bricks(std::span<const std::uint64_t> first, std::size_t width, std::uint64_t begin,
                                      std::span<std::uint8_t> to, const Write& write) const {
  auto b = std::size_t(std::upper_bound(first.begin(), first.end(), begin) - first.begin()) - 1;
  std::array<std::uint8_t, max_row_bytes * brick_voxels> temporary;
  for (std::size_t at = 0; at < to.size(); ++b) {
    const std::size_t rows = first[b + 1] - first[b], skipped = begin > first[b] ? begin - first[b] : 0;
    const std::size_t wanted = std::min((rows - skipped) * width, to.size() - at);
    const bool is_whole = wanted == rows * width;
    write(b, is_whole ? &to[at] : temporary.data());
    if (!is_whole) std::copy_n(temporary.begin() + std::ptrdiff_t(skipped * width), wanted, &to[at]);
    at += wanted;
  }
}

void LevelDifferences::write_children(std::size_t brick, std::uint8_t* to) const {
  const std::uint64_t there = groups_with_parent_of(brick);
  const BrickCodes codes = codes_of(mask_of(brick));
  for (unsigned group = 0; group < groups_per_brick; ++group)
    if (has_children_row(parents_[brick].kind, there, is_dense_, group))
      *to++ = children_of_group(codes[group / 8], group);
}

void LevelDifferences::write_colours(std::size_t brick, std::uint8_t* to) const {
  const ParentVoxels above = parents_of(brick);
  const std::uint8_t* rgba = &level_.rgba[4 * level_.first[brick]];
  for_each_by_code(mask_of(brick), codes_of(mask_of(brick)), [&](unsigned group, std::uint32_t voxel) {
    std::uint32_t rgb;
    std::memcpy(&rgb, rgba + 4 * std::size_t(voxel), sizeof rgb);
    const std::uint32_t difference = colour_difference(rgb, above.rgb[group]);
    for (unsigned c = 0; c < 3; ++c) *to++ = std::uint8_t(difference >> 8 * c);
  });
}

void LevelDifferences::write_normals(std::size_t brick, std::uint8_t* to) const {
  const ParentVoxels above = parents_of(brick);
  const std::int8_t* normals = &level_.normal[2 * level_.first[brick]];
  for_each_by_code(mask_of(brick), codes_of(mask_of(brick)), [&](unsigned group, std::uint32_t voxel) {
    std::uint16_t normal;
    std::memcpy(&normal, normals + 2 * std::size_t(voxel), sizeof normal);
    const std::uint16_t difference = normal_difference(normal, above.normal[group]);
    *to++ = std::uint8_t(difference);
    *to++ = std::uint8_t(difference >> 8);
  });
}

void LevelDifferences::write_coverages(std::size_t brick, std::uint8_t* to) const {
  for (std::size_t v = level_.first[brick]; v < level_.first[brick + 1]; ++v) {
    const std::uint8_t* coverage = coverage_of(v);
    if (!stores_coverage(coverage[directional_coverage_plane], is_complete_)) continue;
    const std::uint8_t predicted = predicted_coverage(coverage[directional_coverage_plane], level_.rgba[4 * v + 3]);
    for (std::size_t axis = 0; axis < coverage_bytes; ++axis) *to++ = std::uint8_t(coverage[axis] - predicted);
  }
}

/// Collects rows of the column `first`.
void LevelDifferences::collect_starts(std::uint64_t begin, std::span<std::uint8_t> to) const {
  for (std::size_t at = 0; at < to.size(); at += row_of(LevelColumn::first).bytes, ++begin) {
    const std::size_t brick = std::min<std::size_t>(begin * bricks_per_start, bricks());
    const std::array<std::uint64_t, 3> row = rows_before(brick);
    std::memcpy(&to[at], row.data(), sizeof row);
  }
}

void LevelDifferences::collect(LevelColumn column, std::uint64_t begin, std::span<std::uint8_t> to) const {
  const std::size_t width = row_of(column).bytes;
  switch (column) {
    case LevelColumn::first:
      return collect_starts(begin, to);
    case LevelColumn::children:
      return collect_bricks(first_children_, width, begin, to,
                            [this](std::size_t b, std::uint8_t* rows) { write_children(b, rows); });
    case LevelColumn::rgb:
      return collect_bricks(level_.first, width, begin, to,
                            [this](std::size_t b, std::uint8_t* rows) { write_colours(b, rows); });
    case LevelColumn::alpha:
      for (std::size_t i = 0; i < to.size(); ++i) to[i] = level_.rgba[4 * (begin + i) + 3];
      return;
    case LevelColumn::normal:
      return collect_bricks(level_.first, width, begin, to,
                            [this](std::size_t b, std::uint8_t* rows) { write_normals(b, rows); });
    case LevelColumn::facing:
      return collect_bricks(first_coverage_, width, begin, to,
                            [this](std::size_t b, std::uint8_t* rows) { write_coverages(b, rows); });
    case LevelColumn::plane:
      for (std::size_t i = 0; i < to.size(); ++i) to[i] = coverage_of(begin + i)[directional_coverage_plane];
      return;
    case LevelColumn::voxel_class:
      std::memcpy(to.data(), level_.voxel_class.data() + begin, to.size());
      return;
  }
}

}  // namespace gigabake
