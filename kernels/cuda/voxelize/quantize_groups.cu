#include "core/octree/octree.h"
#include "kernels/body/voxelize/quantize_groups.h"
#include "kernels/cuda/voxelize/quantize_groups.cuh"

namespace gigabake::kernels {
namespace {

constexpr unsigned threads = 256, warps = threads / 32, groups_a_lane = groups_per_brick / 32;
static_assert(groups_a_lane == 2 && 32 % octants_a_brick == 0, "eight lanes side by side have an octant's groups");

/// The voxel arrays of a level that approximation reads and changes.
struct VoxelsOut {
  const std::uint64_t* mask;
  const std::uint32_t* first;
  std::uint8_t* rgba;
  std::uint16_t* normal;               ///< null if the level has none
  std::uint8_t* directional_coverage;  ///< null if the level has none
  std::uint32_t bricks;
};

/// The 2×2×2 voxel positions of a group in a brick; some of the positions may be empty.
class Group {
 public:
  Group() = default;
  __device__ Group(const std::uint64_t* mask, std::uint32_t first, unsigned number) {
    const unsigned lowest = lowest_voxel_of(number), slice = lowest / 64;
    for (unsigned z = 0; z < slice; ++z) first += unsigned(__popcll(mask[z]));
    lowest_ = lowest % 64;
    for (unsigned z = 0; z < 2; ++z) {
      slice_[z] = mask[slice + z];
      first_[z] = first;
      first += unsigned(__popcll(slice_[z]));
      for (unsigned p = 0; p < 4; ++p) voxels_ += unsigned(slice_[z] >> bit_of(p) & 1);
    }
  }

  __device__ std::uint32_t voxels() const { return voxels_; }

  /// Calls visit(i) for each voxel of the group; i is the voxel's index in its level.
  template <class Visit>
  __device__ void for_each(const Visit& visit) const {
    for (unsigned z = 0; z < 2; ++z)
      for (unsigned p = 0; p < 4; ++p) {
        const unsigned bit = bit_of(p);
        if ((slice_[z] >> bit & 1) != 0)
          visit(first_[z] + unsigned(__popcll(slice_[z] & ((std::uint64_t(1) << bit) - 1))));
      }
  }

 private:
  __device__ unsigned bit_of(unsigned p) const { return lowest_ + p % 2 + 8 * (p / 2); }

  std::uint64_t slice_[2] = {};
  std::uint32_t first_[2] = {};
  unsigned lowest_ = 0, voxels_ = 0;
};

__device__ std::uint32_t sum_of_eight(std::uint32_t count) {
  for (unsigned d = 1; d < octants_a_brick; d *= 2) count += __shfl_xor_sync(~0u, count, d);
  return count;
}

/// A brick distributed over a warp. Lane l owns the groups l and l + 32, and stores the voxel counts of their octants
/// and of the brick.
struct LaneBrick {
  Group group[groups_a_lane];
  std::uint32_t of_octant[groups_a_lane], of_brick;

  __device__ LaneBrick(const VoxelsOut& level, std::uint32_t brick) {
    for (unsigned g = 0; g < groups_a_lane; ++g) {
      group[g] = Group(level.mask + 8 * std::size_t(brick), level.first[brick], threadIdx.x % 32 + 32 * g);
      of_octant[g] = sum_of_eight(group[g].voxels());
    }
    of_brick = level.first[brick + 1] - level.first[brick];
  }
};

/// Returns the range of the lane whose number is this lane's number XOR d.
template <class Range>
__device__ Range of_lane(const Range& own, unsigned d) {
  static_assert(sizeof(Range) % 4 == 0);
  union Words {
    __device__ Words() {}
    Range range;
    std::uint32_t word[sizeof(Range) / 4];
  } words;
  words.range = own;
  for (std::uint32_t& word : words.word) word = __shfl_xor_sync(~0u, word, d);
  return words.range;
}

/// Minimum and maximum over the voxels of each group owned by this lane, of the groups' octants and of the brick.
template <class Range>
struct ShareRanges {
  Range group[groups_a_lane], octant[groups_a_lane], brick;

  /// Computes the ranges of octants and brick from the ranges of the groups. All lanes of the warp must call it.
  __device__ void join() {
    for (unsigned g = 0; g < groups_a_lane; ++g) {
      octant[g] = group[g];
      for (unsigned d = 1; d < octants_a_brick; d *= 2) octant[g].join(of_lane(octant[g], d));
      brick.join(octant[g]);
    }
    for (unsigned d = octants_a_brick; d < 32; d *= 2) brick.join(of_lane(brick, d));
  }
};

/// Approximates channels [begin, begin + channels) of each voxel's bytes together. All lanes of the warp must call it.
template <int channels>
__device__ void quantize_codes(const LaneBrick& brick, std::uint8_t* bytes, unsigned stride, unsigned begin,
                               std::uint32_t codes) {
  ShareRanges<CodeRange> range[channels];
  for (int c = 0; c < channels; ++c) {
    for (unsigned g = 0; g < groups_a_lane; ++g)
      brick.group[g].for_each(
          [&](std::uint32_t v) { range[c].group[g].add(bytes[std::size_t(stride) * v + begin + unsigned(c)]); });
    range[c].join();
  }
  for (unsigned g = 0; g < groups_a_lane; ++g) {
    if (brick.group[g].voxels() == 0) continue;
    bool by_brick = true, by_octant = true, by_group = true;
    for (int c = 0; c < channels; ++c) {
      by_brick = by_brick && range[c].brick.fits(codes);
      by_octant = by_octant && range[c].octant[g].fits(codes);
      by_group = by_group && range[c].group[g].fits(codes);
    }
    if (!by_brick && !by_octant && !by_group) continue;
    const std::uint32_t count = by_brick ? brick.of_brick : by_octant ? brick.of_octant[g] : brick.group[g].voxels();
    for (int c = 0; c < channels; ++c) {
      const CodeRange chosen = by_brick ? range[c].brick : by_octant ? range[c].octant[g] : range[c].group[g];
      const std::uint8_t value = chosen.value(count, codes);
      brick.group[g].for_each([&](std::uint32_t v) { bytes[std::size_t(stride) * v + begin + unsigned(c)] = value; });
    }
  }
}

/// Approximates the normals. All lanes of the warp must call it. No normal is chosen for groups and octants without
/// voxels.
__device__ void quantize_normals(const LaneBrick& brick, std::uint16_t* normal, const std::int16_t* units,
                                 std::uint32_t codes) {
  const auto unit = [&](std::uint16_t code) {
    const std::int16_t* n = units + 4 * std::size_t(code);
    return Vec3<std::int16_t>{n[0], n[1], n[2]};
  };
  ShareRanges<NormalRange> range;
  for (unsigned g = 0; g < groups_a_lane; ++g)
    brick.group[g].for_each([&](std::uint32_t v) { range.group[g].add(unit(normal[v])); });
  range.join();
  range.brick.choose();
  bool off_brick = false, off_octant[groups_a_lane] = {};
  for (unsigned g = 0; g < groups_a_lane; ++g) {
    if (brick.of_octant[g] != 0) range.octant[g].choose();
    if (brick.group[g].voxels() != 0) range.group[g].choose();
    brick.group[g].for_each([&](std::uint32_t v) {
      const Vec3<std::int16_t> own = unit(normal[v]);
      off_brick |= !within_chord(own, unit(range.brick.value), codes);
      off_octant[g] |= !within_chord(own, unit(range.octant[g].value), codes);
      range.group[g].fits = range.group[g].fits && within_chord(own, unit(range.group[g].value), codes);
    });
  }
  const bool by_brick = !__any_sync(~0u, off_brick);
  for (unsigned g = 0; g < groups_a_lane; ++g) {
    const bool by_octant = sum_of_eight(off_octant[g] ? 1 : 0) == 0, by_group = range.group[g].fits;
    if (!by_brick && !by_octant && !by_group) continue;
    const std::uint16_t value = by_brick ? range.brick.value : by_octant ? range.octant[g].value : range.group[g].value;
    brick.group[g].for_each([&](std::uint32_t v) { normal[v] = value; });
  }
}

/// Processes one brick per warp.
__global__ void __launch_bounds__(threads)
    approximate_bricks(const VoxelsOut level, std::uint32_t codes, const std::int16_t* units) {
  const std::uint32_t number = blockIdx.x * warps + threadIdx.x / 32;
  if (number >= level.bricks) return;
  const LaneBrick brick(level, number);
  quantize_codes<3>(brick, level.rgba, 4, 0, codes);
  quantize_codes<1>(brick, level.rgba, 4, 3, codes);
  if (level.directional_coverage != nullptr)
    quantize_codes<coverage_bytes>(brick, level.directional_coverage, unsigned(directional_coverage_bytes), 0, codes);
  if (level.normal != nullptr) quantize_normals(brick, level.normal, units, codes);
}

}  // namespace

void approximate_levels(DeviceHeap& heap, const Tables& tables, std::uint32_t codes, std::vector<DeviceLevel>& levels) {
  if (codes == 0) return;
  for (DeviceLevel& level : levels) {
    const VoxelsOut out{level.mask.data(),
                        level.first.data(),
                        reinterpret_cast<std::uint8_t*>(level.rgba.data()),
                        level.normal.empty() ? nullptr : level.normal.data(),
                        level.directional_coverage.empty() ? nullptr : level.directional_coverage.data(),
                        level.bricks};
    approximate_bricks<<<grid_of(level.bricks, warps), threads, 0, heap.stream()>>>(out, codes, tables.unit_normal);
    check_launch("approximate_bricks");
  }
}

}  // namespace gigabake::kernels
