#include "worker/edit/stored_bricks.h"

#include <algorithm>

#include "format/shard/levels/brick_walk.h"
#include "worker/edit/level_bricks.h"

namespace gigabake {
namespace {

using kernels::Level;

/// Bricks that are fewer apart are read together, because a read unpacks whole chunks.
constexpr std::uint64_t max_gap = 256;

}  // namespace

StoredBricks::StoredBricks(const BaseShard& base) : base_(base), constants_(base.lods()) {
  const NodeTable& nodes = base.nodes();
  for (std::size_t n = 0; n < nodes.key.size(); ++n)
    if (nodes.kind[n] != NodeKind::brick) constants_[nodes.lod[n]].push_back(n);
}

/// Returns the row of a constant node with this key on this level.
std::optional<std::size_t> StoredBricks::constant_row(int lod, std::uint64_t key) const {
  const std::vector<std::size_t>& rows = constants_[std::size_t(lod)];
  const auto key_of = [this](std::size_t row) { return base_.nodes().key[row]; };
  const auto at = std::ranges::lower_bound(rows, key, {}, key_of);
  return at != rows.end() && key_of(*at) == key ? std::optional(*at) : std::nullopt;
}

std::optional<StoredBricks::Place> StoredBricks::find(int lod, std::uint64_t key) const {
  const std::vector<std::uint64_t>& keys = base_.level(std::size_t(lod)).key;
  const auto at = std::lower_bound(keys.begin(), keys.end(), key);
  if (at != keys.end() && *at == key) return Place{false, std::uint64_t(at - keys.begin())};
  if (const auto row = constant_row(lod, key)) return Place{true, *row};
  for (int above = lod + 1; above < int(base_.lods()); ++above)
    if (const auto row = constant_row(above, key >> 3 * (above - lod)))
      if (base_.nodes().kind[*row] == NodeKind::leaf_constant) return Place{true, *row};
  return std::nullopt;
}

std::optional<StoredNode> StoredBricks::node(int lod, std::uint64_t key) const {
  const std::optional<Place> place = find(lod, key);
  if (!place) return std::nullopt;
  if (!place->is_constant) return StoredNode{};
  const NodeTable& nodes = base_.nodes();
  const std::size_t row = place->number;
  DirectionalCoverage finest;
  const std::uint8_t* coverage = directional_coverage_of_constant(nodes, row, nodes.lod[row] == 0, finest);
  return StoredNode{nodes.kind[row],
                    kernels::common_voxel(nodes.value[row], kernels::pack_normal(nodes.normal[row].data()), coverage,
                                          class_of_constant(nodes, row))};
}

std::vector<std::uint64_t> StoredBricks::finest_keys(std::uint64_t first, std::uint64_t end) const {
  const std::vector<std::uint64_t>& bricks = base_.level(0).key;
  std::vector<std::uint64_t> keys(std::lower_bound(bricks.begin(), bricks.end(), first),
                                  std::lower_bound(bricks.begin(), bricks.end(), end));
  const NodeTable& nodes = base_.nodes();
  for (std::size_t lod = 0; lod < constants_.size(); ++lod)
    for (const std::size_t row : constants_[lod]) {
      if (nodes.kind[row] != NodeKind::leaf_constant) continue;
      const std::uint64_t begin = std::max(nodes.key[row] << 3 * lod, first);
      for (std::uint64_t key = begin; key < std::min((nodes.key[row] + 1) << 3 * lod, end); ++key) keys.push_back(key);
    }
  std::sort(keys.begin(), keys.end());
  return keys;
}

void StoredBricks::append_constant(int lod, std::uint64_t key, std::size_t row, Level& out) const {
  if (out.first.empty()) out.first.push_back(0);
  const NodeTable& nodes = base_.nodes();
  const std::uint32_t rgba = nodes.value[row];
  DirectionalCoverage finest;
  const std::uint8_t* coverage = directional_coverage_of_constant(nodes, row, lod == 0, finest);
  out.key.push_back(key);
  out.mask.insert(out.mask.end(), 8, ~std::uint64_t(0));
  out.first.push_back(out.first.back() + brick_voxels);
  for (int v = 0; v < brick_voxels; ++v) {
    for (int c = 0; c < 4; ++c) out.rgba.push_back(kernels::byte_of(rgba, c));
    if (base_.header().has_normals)
      out.normal.insert(out.normal.end(), nodes.normal[row].begin(), nodes.normal[row].end());
    if (coverage != nullptr)
      out.directional_coverage.insert(out.directional_coverage.end(), coverage, coverage + directional_coverage_bytes);
    if (base_.header().has_classes) out.voxel_class.push_back(class_of_constant(nodes, row));
  }
}

/// Appends stored bricks. Reads all bricks from the first number to the last.
void StoredBricks::append_block(int lod, std::span<const std::uint64_t> keys, std::span<const std::uint64_t> numbers,
                                Level& out) const {
  BrickBlock block = base_.bricks(lod, numbers.front(), std::uint32_t(numbers.back() - numbers.front() + 1));
  Level all;
  all.key.resize(block.mask.size() / 8);
  all.mask = std::move(block.mask);
  all.first.assign(block.first.begin(), block.first.end());
  all.rgba = std::move(block.rgba);
  all.normal = std::move(block.normal);
  all.directional_coverage = std::move(block.directional_coverage);
  all.voxel_class = std::move(block.voxel_class);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const std::size_t brick = numbers[i] - numbers.front();
    all.key[brick] = keys[i];
    append_bricks(all, brick, brick + 1, out);
  }
}

Level StoredBricks::read(int lod, std::span<const std::uint64_t> keys) const {
  Level out;
  out.first = {0};
  for (std::size_t i = 0; i < keys.size();) {
    const std::optional<Place> place = find(lod, keys[i]);
    if (place && place->is_constant) append_constant(lod, keys[i], place->number, out);
    if (!place || place->is_constant) {
      ++i;
      continue;
    }
    std::vector<std::uint64_t> at{keys[i]}, numbers{place->number};
    for (++i; i < keys.size(); ++i) {
      const std::optional<Place> next = find(lod, keys[i]);
      if (!next) continue;
      if (next->is_constant || next->number > numbers.back() + max_gap) break;
      at.push_back(keys[i]), numbers.push_back(next->number);
    }
    append_block(lod, at, numbers, out);
  }
  return out;
}

}  // namespace gigabake
