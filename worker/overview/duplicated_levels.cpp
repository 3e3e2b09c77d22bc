#include "worker/overview/duplicated_levels.h"

#include <algorithm>
#include <bit>
#include <tuple>

#include "core/base/error.h"
#include "core/math/box3.h"
#include "core/octree/morton.h"

namespace gigabake {
namespace {

constexpr std::uint64_t all_voxels[8] = {~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull};
constexpr std::int8_t no_normal[2] = {0, 0};
constexpr std::uint8_t no_directional_coverage[directional_coverage_bytes] = {};

/// A borrowed view of a child's brick, or of a brick expanded from a constant node.
struct BrickView {
  const std::uint64_t* mask;
  const std::uint8_t* rgba;
  const std::int8_t* normal;
  const std::uint8_t* directional_coverage;
  bool is_constant;                           ///< all voxels have the same value
  bool has_normal, has_directional_coverage;  ///< if false, `normal` or `directional_coverage` points to zeros
  const VoxelClass* voxel_class = nullptr;    ///< null: the child has no classes

  std::size_t at(std::size_t voxel) const { return is_constant ? 0 : voxel; }
};

/// The voxels of a child's brick that lie in one brick of the window.
struct PlacedBrick {
  std::uint64_t key;        ///< Morton code of the window's brick
  Vec3<std::int8_t> shift;  ///< position of the child's brick in the window's brick, voxels; 0: aligned
  std::uint32_t child, node;
  auto order() const { return std::tie(key, child, node, shift); }
};

/// The join of one level of all children in the window.
class LevelJoin {
 public:
  LevelJoin(std::span<const ChildLevels* const> children, const DuplicatedWindow& window, std::uint32_t lod)
      : children_(children), window_(window), lod_(lod), edge_(std::int64_t(window.edge) >> lod >> 3) {
    for (std::uint32_t c = 0; c < children.size(); ++c) place_bricks(c);
    std::sort(bricks_.begin(), bricks_.end(),
              [](const PlacedBrick& a, const PlacedBrick& b) { return a.order() < b.order(); });
    for (std::size_t i = 0; i < bricks_.size(); ++i)
      if (i == 0 || bricks_[i].key != bricks_[i - 1].key) begins_.push_back(i);
    begins_.push_back(bricks_.size());
  }

  kernels::Level run(const ThreadPool& pool) {
    const std::size_t bricks = begins_.size() - 1;
    kernels::Level level;
    level.key.resize(bricks), level.mask.resize(8 * bricks), level.first.resize(bricks + 1);
    pool.parallel_for(bricks, bricks_a_task, [&](std::size_t begin, std::size_t end, int) {
      for (std::size_t b = begin; b < end; ++b) {
        level.key[b] = bricks_[begins_[b]].key;
        level.first[b + 1] = find_mask(b, &level.mask[8 * b]);
      }
    });
    drop_empty(level);
    for (std::size_t b = 0; b < level.key.size(); ++b) level.first[b + 1] += level.first[b];
    const std::size_t voxels = level.first.back();
    level.rgba.resize(4 * voxels);
    level.normal.resize(window_.normals ? 2 * voxels : 0);
    level.directional_coverage.resize(window_.directional_coverage ? directional_coverage_bytes * voxels : 0);
    level.voxel_class.resize(window_.classes ? voxels : 0);
    pool.parallel_for(level.key.size(), bricks_a_task, [&](std::size_t begin, std::size_t end, int) {
      for (std::size_t b = begin; b < end; ++b) fill(b, level);
    });
    return level;
  }

 private:
  static constexpr std::size_t bricks_a_task = 64;

  /// Adds the bricks of child `c` on this level to bricks_; expands constant nodes.
  void place_bricks(std::uint32_t c) {
    const ChildLevels& child = *children_[c];
    const NodeTable& n = child.coarse.nodes;
    const int own_lod = int(lod_) - int(child.first_lod);
    if (lod_ < child.begin || lod_ - child.begin >= child.coarse.levels.size())
      throw InputError("parent", "children", "a child has no level " + std::to_string(lod_));
    for (std::uint32_t node = 0; node < n.key.size() && n.lod[node] >= own_lod; ++node) {
      const int down = n.lod[node] - own_lod;
      if (n.kind[node] == NodeKind::leaf_constant || down == 0)
        for (std::uint64_t part = 0; part < std::uint64_t(1) << 3 * down; ++part)
          place(child, c, node, demorton(n.key[node] << 3 * down | part));
    }
  }

  void place(const ChildLevels& child, std::uint32_t c, std::uint32_t node, BrickCoordinate at) {
    const Vec3i64 voxel = ((child.lattice_min - window_.min) >> int(lod_)) + Vec3i64(at) * brick_edge;
    const Vec3i64 low = voxel >> 3, over = voxel - (low << 3);  // over: voxels, offset from brick `low`
    const auto bricks = Box3i64::cube({}, edge_);
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3i64 next{corner & 1, corner >> 1 & 1, corner >> 2}, to = low + next;
      const bool overlaps = min_by_axis(next, over) == next;
      if (!overlaps || !bricks.contains(to)) continue;
      bricks_.push_back({morton(std::uint32_t(to[0]), std::uint32_t(to[1]), std::uint32_t(to[2])),
                         Vec3<std::int8_t>(over - next * brick_edge), c, node});
    }
  }

  BrickView view(const PlacedBrick& brick) const {
    const ChildLevels& child = *children_[brick.child];
    const NodeTable& n = child.coarse.nodes;
    const std::uint32_t node = brick.node;
    BrickView view{all_voxels, nullptr, no_normal, no_directional_coverage, n.kind[node] != NodeKind::brick,
                   false,      false};
    if (view.is_constant) {
      view.rgba = reinterpret_cast<const std::uint8_t*>(&n.value[node]);
      view.normal = n.normal[node].data();
      view.has_normal = true;
      view.has_directional_coverage = !n.directional_coverage.empty() && lod_ > child.first_lod;
      if (view.has_directional_coverage) view.directional_coverage = n.directional_coverage[node].data();
      if (!n.voxel_class.empty()) view.voxel_class = &n.voxel_class[node];
      return view;
    }
    const BrickLevel& level = child.coarse.levels[lod_ - child.begin];
    const std::size_t b = n.value[node], first = level.first[b];
    view.mask = &level.mask[8 * b];
    view.rgba = &level.rgba[4 * first];
    view.has_normal = !level.normal.empty();
    if (view.has_normal) view.normal = &level.normal[2 * first];
    view.has_directional_coverage = !level.directional_coverage.empty();
    if (view.has_directional_coverage)
      view.directional_coverage = &level.directional_coverage[directional_coverage_bytes * first];
    if (!level.voxel_class.empty()) view.voxel_class = &level.voxel_class[first];
    return view;
  }

  bool is_whole(std::size_t b) const {
    return begins_[b + 1] - begins_[b] == 1 && bricks_[begins_[b]].shift == Vec3<std::int8_t>{};
  }

  /// Calls visit(bit, voxel) for each voxel of the view that lies in the window's brick. `bit` is the voxel's position
  /// in that brick; `voxel` is its index in the view.
  template <class Visit>
  static void for_each_voxel_in(const PlacedBrick& brick, const BrickView& view, const Visit& visit) {
    std::size_t voxel = 0;
    for (int z = 0; z < 8; ++z)
      for (std::uint64_t rest = view.mask[z]; rest != 0; rest &= rest - 1, ++voxel) {
        const int bit = std::countr_zero(rest);
        const int x = (bit & 7) + brick.shift[0], y = (bit >> 3) + brick.shift[1], at_z = z + brick.shift[2];
        if (((x | y | at_z) & ~7) == 0) visit(std::uint32_t(x + 8 * y + 64 * at_z), voxel);
      }
  }

  /// Builds the mask of the window's brick `b` and returns the number of voxels in that brick.
  std::uint64_t find_mask(std::size_t b, std::uint64_t* mask) const {
    std::uint64_t voxels = 0;
    for (std::size_t i = begins_[b]; i < begins_[b + 1]; ++i) {
      const BrickView from = view(bricks_[i]);
      if (is_whole(b)) {
        std::copy_n(from.mask, 8, mask);
        for (int w = 0; w < 8; ++w) voxels += std::uint64_t(std::popcount(mask[w]));
        continue;
      }
      for_each_voxel_in(bricks_[i], from, [&](std::uint32_t bit, std::size_t) {
        const std::uint64_t one = std::uint64_t(1) << (bit & 63);
        if ((mask[bit >> 6] & one) != 0)
          throw InputError("parent", "children", "two children have a voxel at the same position");
        mask[bit >> 6] |= one;
        ++voxels;
      });
    }
    return voxels;
  }

  /// Removes bricks without voxels. A child's brick that overlaps several bricks of the window may have voxels in only
  /// some of these.
  void drop_empty(kernels::Level& level) {
    std::size_t to = 0;
    for (std::size_t b = 0; b < level.key.size(); ++b) {
      if (level.first[b + 1] == 0) continue;
      level.key[to] = level.key[b];
      level.first[to + 1] = level.first[b + 1];
      std::copy_n(&level.mask[8 * b], 8, &level.mask[8 * to]);
      kept_.push_back(b);
      ++to;
    }
    level.key.resize(to), level.mask.resize(8 * to), level.first.resize(to + 1);
  }

  void fill(std::size_t b, kernels::Level& level) const {
    const std::size_t begin = begins_[kept_[b]], end = begins_[kept_[b] + 1], first = level.first[b];
    const std::uint64_t* mask = &level.mask[8 * b];
    std::uint16_t place[brick_voxels];  // place[bit]: number of the brick's voxels before that bit
    std::uint16_t voxels = 0;
    for (std::uint32_t bit = 0; bit < brick_voxels; ++bit) {
      place[bit] = voxels;
      voxels = std::uint16_t(voxels + (mask[bit >> 6] >> (bit & 63) & 1));
    }
    for (std::size_t i = begin; i < end; ++i) {
      const BrickView from = view(bricks_[i]);
      if (is_whole(kept_[b]) && !from.is_constant) {
        copy(from, 0, voxels, first, level);
        continue;
      }
      for_each_voxel_in(bricks_[i], from, [&](std::uint32_t bit, std::size_t voxel) {
        copy(from, from.at(voxel), 1, first + place[bit], level);
      });
    }
  }

  void copy(const BrickView& from, std::size_t voxel, std::size_t count, std::size_t to, kernels::Level& level) const {
    std::copy_n(from.rgba + 4 * voxel, 4 * count, &level.rgba[4 * to]);
    if (window_.normals && from.has_normal) std::copy_n(from.normal + 2 * voxel, 2 * count, &level.normal[2 * to]);
    if (window_.directional_coverage && from.has_directional_coverage)
      std::copy_n(from.directional_coverage + directional_coverage_bytes * voxel, directional_coverage_bytes * count,
                  &level.directional_coverage[directional_coverage_bytes * to]);
    if (window_.classes && from.voxel_class != nullptr)
      std::copy_n(from.voxel_class + voxel, count, &level.voxel_class[to]);
  }

  const std::span<const ChildLevels* const> children_;
  const DuplicatedWindow& window_;
  const std::uint32_t lod_;
  const std::int64_t edge_;          ///< edge of the window, in bricks of this level
  std::vector<PlacedBrick> bricks_;  ///< sorted by brick of the window
  /// Per brick of the window, the index of its first entry in bricks_. The last element is the size of bricks_.
  std::vector<std::size_t> begins_;
  std::vector<std::size_t> kept_;  ///< indices in begins_ of bricks that have voxels
};

}  // namespace

ChildLevels read_child_levels(const ShardReader& reader, std::uint32_t begin) {
  const ShardHeader& h = reader.header();
  ChildLevels child{h.lattice_min, h.first_lod, begin, {}};
  if (begin >= h.first_lod + h.lods) return child;
  if (begin < h.first_lod) throw InputError(reader.path(), "/lod_0", "the shard has no level " + std::to_string(begin));
  child.coarse = reader.coarse_levels(int(begin - h.first_lod));
  return child;
}

std::vector<kernels::Level> joined_levels(std::span<const ChildLevels* const> children, const DuplicatedWindow& window,
                                          const ThreadPool& pool) {
  std::vector<kernels::Level> levels;
  for (std::uint32_t lod = window.begin; lod < window.end; ++lod)
    levels.push_back(LevelJoin(children, window, lod).run(pool));
  return levels;
}

}  // namespace gigabake
