#include "format/shard/columns/predicted_level.h"

#include <algorithm>
#include <cstring>

#include "core/base/error.h"
#include "format/shard/check/broken_rule.h"
#include "format/shard/check/shard_check.h"
#include "format/shard/packed_shard.h"
#include "format/shard/shard_layout.h"

namespace gigabake {
namespace {

constexpr const char* wrong_starts = "does not count the rows of the bricks";

}  // namespace

struct PredictedLevel::Range {
  std::uint64_t begin;
  std::span<const BrickParent> parents;
  const SomeBricks& above;
  std::vector<Starts> starts;
  std::vector<BrickCodes> codes;
  BrickLevel out;

  std::size_t bricks() const { return parents.size(); }
  std::uint64_t voxels() const { return out.first.back(); }
};

PredictedLevel::PredictedLevel(const ColumnSource& source, const ShardHeader& header, int lod, std::uint64_t bricks)
    : source_(source), lod_(lod), bricks_(bricks) {
  for (const LevelColumn column : level_columns(header, lod)) columns_[std::size_t(column)].is_stored = true;
  const std::uint64_t starts = (bricks + bricks_per_start - 1) / bricks_per_start;
  expect(rows(LevelColumn::first).rows() == starts + 1, LevelColumn::first, 0,
         "the number of bricks differs from the nodes of this level");
  totals_ = read_rows<Starts>(LevelColumn::first, starts, 1)[0];
  expect(read_rows<Starts>(LevelColumn::first, 0, 1)[0] == Starts{} || starts == 0, LevelColumn::first, 0,
         "does not begin at 0");
  expect(voxels() <= bricks * brick_voxels && (starts != 0 || totals_ == Starts{}), LevelColumn::first, starts,
         wrong_starts);
  is_dense_ = totals_[of_children] == bricks * groups_per_brick;
  is_complete_ = totals_[of_facing] == totals_[of_voxels];
}

const StoredRows& PredictedLevel::rows(LevelColumn column) const {
  Column& of = columns_[std::size_t(column)];
  const std::scoped_lock lock(of.opening);
  if (of.rows != nullptr) return *of.rows;
  std::unique_ptr<StoredRows> opened = source_.open(level_column(lod_, column));
  if (column != LevelColumn::first)
    expect(opened->rows() == totals_[counted_by(column)], column, 0, "does not match first");
  of.rows = std::move(opened);
  return *of.rows;
}

void PredictedLevel::check_all_columns() const {
  for (std::size_t column = 0; column < columns_.size(); ++column)
    if (has(LevelColumn(column))) rows(LevelColumn(column));
}

std::string PredictedLevel::name(LevelColumn column) const { return level_column(lod_, column).name; }

void PredictedLevel::expect(bool holds, LevelColumn column, std::uint64_t row, const char* rule) const {
  if (!holds) BrokenRule{source_.path(), name(column)}.expect(false, row, rule);
}

/// Reads rows of a column, one T or several per row.
template <class T>
std::vector<T> PredictedLevel::read_rows(LevelColumn column, std::uint64_t first, std::uint64_t count) const {
  const StoredRows& from = rows(column);
  std::vector<T> out(count * row_of(column).bytes / sizeof(T));
  from.read(first, count, out.data());
  return out;
}

/// Returns the starts of every bricks_per_start-th brick from `begin` on, and those after the last brick. Checks that
/// they are ascending and inside the columns.
std::vector<PredictedLevel::Starts> PredictedLevel::read_starts(std::uint64_t begin, std::uint64_t bricks) const {
  const std::uint64_t first = begin / bricks_per_start, count = (bricks + bricks_per_start - 1) / bricks_per_start + 1;
  std::vector<Starts> starts = read_rows<Starts>(LevelColumn::first, first, count);
  for (std::size_t s = 0; s < starts.size(); ++s)
    for (std::size_t c = 0; c < totals_.size(); ++c)
      expect(starts[s][c] <= totals_[c] && (s == 0 || starts[s][c] >= starts[s - 1][c]), LevelColumn::first, first + s,
             wrong_starts);
  return starts;
}

/// Returns the starts that are stored for brick `brick` of the range, or null.
const PredictedLevel::Starts* PredictedLevel::starts_at(const Range& range, std::size_t brick) const {
  if (brick % bricks_per_start != 0 && range.begin + brick != bricks_) return nullptr;
  return &range.starts[(brick + bricks_per_start - 1) / bricks_per_start];
}

/// Sets the masks, the codes and the first voxels.
void PredictedLevel::read_masks(Range& range) const {
  std::vector<std::uint64_t> there(range.bricks());
  std::vector<std::uint64_t> first_row(range.bricks() + 1);
  for (std::size_t b = 0; b < range.bricks(); ++b) {
    const BrickParent& parent = range.parents[b];
    there[b] = groups_with_parent(parent, range.above);
    first_row[b + 1] = first_row[b] + children_rows(parent.kind, there[b], is_dense_);
  }
  const std::uint64_t begin = range.starts[0][of_children];
  expect(first_row.back() <= totals_[of_children] - begin, LevelColumn::first, range.begin / bricks_per_start,
         wrong_starts);
  const auto rows = read_rows<std::uint8_t>(LevelColumn::children, begin, first_row.back());
  range.codes.assign(range.bricks(), {});
  range.out.mask.assign(brick_edge * range.bricks(), 0);
  range.out.first.assign(1, 0);
  for (std::size_t b = 0, row = 0; b < range.bricks(); ++b) {
    std::uint64_t* mask = &range.out.mask[brick_edge * b];
    for (unsigned group = 0; group < groups_per_brick; ++group)
      if (has_children_row(range.parents[b].kind, there[b], is_dense_, group))
        range.codes[b][group / 8] |= std::uint64_t(rows[row++]) << 8 * (group % 8);
    for (unsigned octant = 0; octant < octants_a_brick; ++octant) set_octant(range.codes[b][octant], octant, mask);
    range.out.first.push_back(range.out.first.back() + WordRanks(mask).voxels);
    expect(range.out.first[b + 1] > range.out.first[b], LevelColumn::children, begin + first_row[b],
           "a brick has no voxels");
  }
  for (std::size_t b = 0; b <= range.bricks(); ++b)
    if (const Starts* starts = starts_at(range, b); starts != nullptr)
      expect((*starts)[of_voxels] - range.starts[0][of_voxels] == range.out.first[b] &&
                 (*starts)[of_children] - begin == first_row[b],
             LevelColumn::first, (range.begin + b) / bricks_per_start, wrong_starts);
  expect(range.voxels() <= voxels() - range.starts[0][of_voxels], LevelColumn::first, range.begin / bricks_per_start,
         wrong_starts);
}

/// Sets alphas and planes.
void PredictedLevel::read_values(Range& range) const {
  const std::uint64_t first = range.starts[0][of_voxels], count = range.voxels();
  range.out.rgba.resize(4 * count);
  const auto alpha = read_rows<std::uint8_t>(LevelColumn::alpha, first, count);
  for (std::size_t v = 0; v < count; ++v) range.out.rgba[4 * v + 3] = alpha[v];
  if (has(LevelColumn::voxel_class))
    range.out.voxel_class = read_rows<VoxelClass>(LevelColumn::voxel_class, first, count);
  if (!has(LevelColumn::facing) && !has(LevelColumn::plane)) return;
  range.out.directional_coverage.resize(directional_coverage_bytes * count);
  if (!has(LevelColumn::plane)) return;
  const auto plane = read_rows<std::uint8_t>(LevelColumn::plane, first, count);
  for (std::size_t v = 0; v < count; ++v)
    range.out.directional_coverage[directional_coverage_bytes * v + directional_coverage_plane] = plane[v];
}

/// Sets the coverages along the axes of voxels that store them; the others have zeros.
void PredictedLevel::read_coverages(Range& range) const {
  std::vector<std::uint8_t>& out = range.out.directional_coverage;
  const auto voxel = [&](std::size_t v) { return &out[directional_coverage_bytes * v]; };
  const std::uint64_t first = range.starts[0][of_facing];
  std::uint64_t count = 0;
  for (std::size_t b = 0;; ++b) {
    const Starts* starts = starts_at(range, b);
    expect(starts == nullptr || (*starts)[of_facing] - first == count, LevelColumn::first,
           (range.begin + b) / bricks_per_start, wrong_starts);
    if (b == range.bricks()) break;
    for (std::size_t v = range.out.first[b]; v < range.out.first[b + 1]; ++v)
      count += stores_coverage(voxel(v)[directional_coverage_plane], is_complete_) ? 1 : 0;
  }
  expect(count <= totals_[of_facing] - first, LevelColumn::first, range.begin / bricks_per_start, wrong_starts);
  const auto rows = read_rows<std::uint8_t>(LevelColumn::facing, first, count);
  const std::uint8_t* row = rows.data();
  for (std::size_t v = 0; v < range.voxels(); ++v) {
    if (!stores_coverage(voxel(v)[directional_coverage_plane], is_complete_)) continue;
    const std::uint8_t predicted = predicted_coverage(voxel(v)[directional_coverage_plane], range.out.rgba[4 * v + 3]);
    for (std::size_t axis = 0; axis < coverage_bytes; ++axis) voxel(v)[axis] = std::uint8_t(*row++ + predicted);
  }
}

/// Sets colours and normals: adds the differences to the predictions.
void PredictedLevel::add_differences(Range& range) const {
  const std::uint64_t first = range.starts[0][of_voxels], count = range.voxels();
  const auto colours = read_rows<std::uint8_t>(LevelColumn::rgb, first, count);
  const auto normals = has(LevelColumn::normal) ? read_rows<std::uint8_t>(LevelColumn::normal, first, count)
                                                : std::vector<std::uint8_t>();
  if (has(LevelColumn::normal)) range.out.normal.resize(2 * count);
  std::size_t row = 0;
  for (std::size_t b = 0; b < range.bricks(); ++b) {
    const ParentVoxels above = parent_voxels(range.parents[b], range.above);
    const std::size_t begin = range.out.first[b];
    for_each_by_code(&range.out.mask[brick_edge * b], range.codes[b], [&](unsigned group, std::uint32_t voxel) {
      std::uint8_t* rgba = &range.out.rgba[4 * (begin + voxel)];
      const std::uint8_t* difference = &colours[3 * row];
      const std::uint32_t rgb = colour_from_difference(
          std::uint32_t(difference[0] | difference[1] << 8 | difference[2] << 16), above.rgb[group]);
      for (unsigned c = 0; c < 3; ++c) rgba[c] = std::uint8_t(rgb >> 8 * c);
      if (!normals.empty()) {
        const std::uint16_t normal =
            normal_from_difference(std::uint32_t(normals[2 * row] | normals[2 * row + 1] << 8), above.normal[group]);
        std::memcpy(&range.out.normal[2 * (begin + voxel)], &normal, sizeof normal);
      }
      ++row;
    });
  }
}

BrickLevel PredictedLevel::read(std::uint64_t begin, std::span<const BrickParent> parents, const SomeBricks& above,
                                Values values) const {
  Range range{begin, parents, above, {}, {}, {}};
  range.out.first = {0};
  if (values == Values::all) check_all_columns();
  if (parents.empty()) return std::move(range.out);
  for (const BrickParent& parent : parents)
    if (parent.kind == BrickParent::brick && !above.contains(parent.value))
      BrokenRule{source_.path(), level_group(lod_)}.expect(false, begin, "a parent is not a brick of the level above");
  range.starts = read_starts(begin, parents.size());
  read_masks(range);
  if (values == Values::masks) return std::move(range.out);
  if (values == Values::predictions) {
    range.out.rgba.resize(4 * range.voxels());
    add_differences(range);
    return std::move(range.out);
  }
  read_values(range);
  if (has(LevelColumn::facing)) read_coverages(range);
  add_differences(range);
  check_coverage(source_.path(), lod_, range.starts[0][of_voxels], range.out.rgba);
  check_planes(source_.path(), lod_, range.starts[0][of_voxels], range.out.directional_coverage);
  return std::move(range.out);
}

}  // namespace gigabake
