#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstring>

#include "format/shard/columns/shared_values.h"
#include "format/shard/columns/voxel_groups.h"

namespace gigabake {
namespace {

constexpr std::size_t bricks_per_range = 2048, voxels_per_range = 1 << 17;

using ValueBytes = ChannelBytes<const std::uint8_t>;

/// One channel of a brick's voxels.
struct BrickVoxels {
  std::span<const std::uint8_t> group;  ///< group of each voxel
  std::uint64_t seen;                   ///< bit g: group g has voxels
  ValueBytes bytes;
};

/// The values of a brick by group.
struct BrickGroups {
  std::array<std::uint32_t, groups_per_brick> first;
  std::uint64_t mixed = 0;  ///< bit g: the voxels of group g differ
  std::uint32_t mixed_voxels = 0;
};

/// Finds the first value of each group, and the groups whose voxels differ.
/// Range   The brick has at least one voxel.
template <class Width>
BrickGroups compare_groups(const BrickVoxels& brick, Width width) {
  BrickGroups out;
  std::array<std::uint32_t, brick_voxels> value;
  const std::size_t voxels = brick.group.size();
  const std::uint32_t first = value_at(brick.bytes[0], width);
  std::uint32_t different = 0;
  for (std::size_t v = 0; v < voxels; ++v) {
    value[v] = value_at(brick.bytes[v], width);
    different |= value[v] ^ first;
  }
  if (different == 0) {  // most bricks of the alpha channel of opaque surfaces
    out.first.fill(first);
    return out;
  }
  // Iterates in reverse, so that the value of each group's first voxel remains.
  for (std::size_t v = voxels; v-- > 0;) out.first[brick.group[v]] = value[v];
  for (std::size_t v = 0; v < voxels; ++v)
    out.mixed |= std::uint64_t(value[v] != out.first[brick.group[v]]) << brick.group[v];
  if (out.mixed != 0)
    for (std::size_t v = 0; v < voxels; ++v) out.mixed_voxels += std::uint32_t(out.mixed >> brick.group[v] & 1);
  return out;
}

/// Writes the brick's share bytes to `share`. Returns the number of values to store for the brick.
template <class Width>
std::size_t find_shares(const BrickVoxels& brick, Width width, std::uint8_t* share) {
  const BrickGroups groups = brick.seen == 0 ? BrickGroups{} : compare_groups(brick, width);
  return share_brick({groups.first.data(), brick.seen, groups.mixed}, groups.mixed_voxels, share);
}

/// Writes one value for each set of voxels that share a value according to `share`. The value is copied from the first
/// voxel of the set.
template <class Width>
void collect_values(const BrickVoxels& brick, Width width, const std::uint8_t* share, std::span<std::uint8_t> to) {
  if (share[9] != 0) {
    std::copy_n(brick.bytes[0], to.size(), to.begin());
    return;
  }
  const ValueLeaders leaders(share);
  // Copies the value of every voxel, because a branch would be mispredicted. The next voxel overwrites a value that is
  // not new.
  std::array<std::uint8_t, max_value_bytes*(brick_voxels + 1)> value;
  std::uint64_t led = 0;
  std::size_t values = 0;
  for (std::size_t v = 0; v < brick.group.size(); ++v) {
    const unsigned group = brick.group[v];
    const bool is_new = leaders.is_new(group, led);
    led |= std::uint64_t(1) << leaders.leader(group);
    std::memcpy(&value[values * width], brick.bytes[v], width);
    values += is_new;
  }
  std::copy_n(value.begin(), to.size(), to.begin());
}

bool all_alike(ValueBytes bytes, std::size_t width, std::size_t voxels, const ThreadPool& pool) {
  std::atomic<bool> differ{false};
  pool.parallel_for(voxels, voxels_per_range, [&](std::size_t begin, std::size_t end, int) {
    with_known_width(width, [&](auto known) {
      const std::uint32_t first = value_at(bytes[0], known);
      constexpr std::size_t at_a_time = 256;
      for (std::size_t v = begin; v < end && !differ; v += at_a_time) {
        std::uint32_t bits = 0;
        for (std::size_t i = v; i < std::min(end, v + at_a_time); ++i) bits |= value_at(bytes[i], known) ^ first;
        if (bits != 0) differ = true;
      }
    });
  });
  return !differ;
}

BrickVoxels brick_voxels_of(const VoxelGroups& groups, std::span<const std::uint64_t> first, ValueBytes bytes,
                            std::size_t b) {
  return {std::span(groups.of_voxel).subspan(first[b], first[b + 1] - first[b]),
          groups.seen[b],
          {bytes[first[b]], bytes.stride}};
}

}  // namespace

VoxelGroups group_voxels(std::span<const std::uint64_t> mask, std::span<const std::uint64_t> first,
                         const ThreadPool& pool) {
  VoxelGroups out;
  out.of_voxel.resize(first.back());
  out.seen.resize(first.size() - 1);
  pool.parallel_for(out.seen.size(), bricks_per_range, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t b = begin; b < end; ++b) {
      std::uint8_t* to = out.of_voxel.data() + first[b];
      for_each_group_of_voxels(&mask[8 * b], [&](std::uint8_t group) {
        *to++ = group;
        out.seen[b] |= std::uint64_t(1) << group;
      });
    }
  });
  return out;
}

SharedValues::SharedValues(ValueBytes bytes, std::size_t width, std::size_t voxels)
    : bytes_(bytes), width_(width), count_(voxels) {}

SharedValues::SharedValues(const VoxelGroups& groups, std::span<const std::uint64_t> voxel_first, ValueBytes bytes,
                           std::size_t width, const ThreadPool& pool)
    : SharedValues(bytes, width, groups.of_voxel.size()) {
  groups_ = &groups;
  voxel_first_ = voxel_first;
  if (count_ > 1 && all_alike(bytes_, width_, count_, pool))
    count_ = 1;
  else
    find(pool);
}

void SharedValues::find(const ThreadPool& pool) {
  const std::size_t bricks = groups_->seen.size();
  share_.resize(share_bytes * bricks);
  first_.resize(bricks + 1);
  pool.parallel_for(bricks, bricks_per_range, [&](std::size_t begin, std::size_t end, int) {
    with_known_width(width_, [&](auto known) {
      for (std::size_t b = begin; b < end; ++b)
        first_[b + 1] =
            find_shares(brick_voxels_of(*groups_, voxel_first_, bytes_, b), known, &share_[share_bytes * b]);
    });
  });
  for (std::size_t b = 0; b < bricks; ++b) first_[b + 1] += first_[b];
  if (how_stored(count_, false, first_.back(), bricks, width_) == ValuesStored::shared) {
    count_ = first_.back();
  } else {
    share_ = {};
    first_ = {};
  }
}

void SharedValues::collect(std::uint64_t begin, std::span<std::uint8_t> to) const {
  if (!share_.empty()) return collect_shared(begin, to);
  with_known_width(width_, [&](auto known) {
    const std::size_t values = to.size() / known;
    for (std::size_t i = 0; i < values; ++i) std::memcpy(&to[i * known], bytes_[begin + i], known);
  });
}

/// Always decodes whole bricks. A brick that `to` covers only partly is decoded into a temporary buffer, and the
/// requested values are copied from there.
void SharedValues::collect_shared(std::uint64_t begin, std::span<std::uint8_t> to) const {
  auto b = std::size_t(std::upper_bound(first_.begin(), first_.end(), begin) - first_.begin()) - 1;
  with_known_width(width_, [&](auto known) {
    std::array<std::uint8_t, max_value_bytes * brick_voxels> temporary;
    for (std::size_t at = 0; at < to.size(); ++b) {
      const std::size_t values = first_[b + 1] - first_[b], skipped = begin > first_[b] ? begin - first_[b] : 0;
      const std::size_t wanted = std::min((values - skipped) * known, to.size() - at);
      const bool is_whole = wanted == values * known;
      const std::span<std::uint8_t> into =
          is_whole ? to.subspan(at, wanted) : std::span(temporary).first(values * known);
      collect_values(brick_voxels_of(*groups_, voxel_first_, bytes_, b), known, &share_[share_bytes * b], into);
      if (!is_whole) std::copy_n(temporary.begin() + std::ptrdiff_t(skipped * known), wanted, &to[at]);
      at += wanted;
    }
  });
}

}  // namespace gigabake
