#include "format/shared_values.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace gigabake {
namespace {

constexpr std::size_t groups = 64, bricks_per_range = 2048, voxels_per_range = 1 << 17;
constexpr std::size_t own = groups;  ///< the voxel has a value of its own

/// 8·octant + group of voxel (x, y, z), by x + 8y + 64z.
constexpr std::array<std::uint8_t, brick_voxels> group_of_voxel = [] {
  std::array<std::uint8_t, brick_voxels> group{};
  for (unsigned v = 0; v < brick_voxels; ++v) {
    const unsigned octant = (v >> 2 & 1) | (v >> 5 & 1) << 1 | (v >> 8 & 1) << 2;
    const unsigned within = (v >> 1 & 1) | (v >> 4 & 1) << 1 | (v >> 7 & 1) << 2;
    group[v] = std::uint8_t(8 * octant + within);
  }
  return group;
}();

/// visit(group) for each voxel of the brick, in order.
template <class Visit>
void for_each_group_of_voxels(const std::uint64_t* mask, const Visit& visit) {
  for (unsigned z = 0; z < brick_edge; ++z)
    for (std::uint64_t rest = mask[z]; rest != 0; rest &= rest - 1)
      visit(group_of_voxel[64 * z + unsigned(std::countr_zero(rest))]);
}

std::size_t count_voxels(const std::uint64_t* mask) {
  int bits = 0;
  for (std::size_t z = 0; z < brick_edge; ++z) bits += std::popcount(mask[z]);
  return std::size_t(bits);
}

/// For each group of voxels the lowest one with which it shares, or `own`.
std::array<std::uint8_t, groups> leaders(const std::uint8_t* share) {
  std::array<std::uint8_t, groups> leader{};
  for (unsigned g = 0; g < groups; ++g) {
    const unsigned octant = g / 8;
    const bool whole = share[9] != 0, by_octant = (share[8] >> octant & 1) != 0,
               by_group = (share[octant] >> g % 8 & 1) != 0;
    leader[g] = std::uint8_t(whole ? 0 : by_octant ? 8 * octant : by_group ? g : own);
  }
  return leader;
}

/// visit(voxel, value, is_new): numbers from the brick's first on. Returns the number of values.
template <class Visit>
std::size_t for_each_value(const std::uint64_t* mask, const std::uint8_t* share, const Visit& visit) {
  const std::array<std::uint8_t, groups> leader = leaders(share);
  std::array<std::int16_t, groups> value_of;
  value_of.fill(-1);
  std::size_t voxel = 0, values = 0;
  for_each_group_of_voxels(mask, [&](std::uint8_t group) {
    const std::uint8_t by = leader[group];
    const bool is_new = by == own || value_of[by] < 0;
    const std::size_t value = is_new ? values++ : std::size_t(value_of[by]);
    if (by != own) value_of[by] = std::int16_t(value);
    visit(voxel++, value, is_new);
  });
  return values;
}

/// The groups of a brick that have voxels.
struct BrickGroups {
  std::array<const std::uint8_t*, groups> value;  ///< of the first voxel, where there is one
  std::array<std::uint8_t, groups> voxels{};
  std::uint64_t seen = 0, mixed = 0;  ///< a bit a group: has voxels, that differ
};

template <class Width>
BrickGroups compare_groups(const std::uint64_t* mask, ChannelBytes<const std::uint8_t> bytes, Width width) {
  BrickGroups all;
  std::size_t voxel = 0;
  for_each_group_of_voxels(mask, [&](std::uint8_t g) {
    const std::uint8_t* value = bytes[voxel++];
    const std::uint64_t bit = std::uint64_t(1) << g;
    if ((all.seen & bit) == 0) all.value[g] = value;
    all.seen |= bit;
    if (std::memcmp(all.value[g], value, width) != 0) all.mixed |= bit;
    ++all.voxels[g];
  });
  return all;
}

/// Whether all voxels of these groups are alike.
template <class Width>
bool are_alike(const BrickGroups& all, std::uint64_t which, Width width) {
  if ((all.mixed & which) != 0) return false;
  const std::uint8_t* value = all.value[std::size_t(std::countr_zero(which))];
  for (std::uint64_t rest = which & (which - 1); rest != 0; rest &= rest - 1)
    if (std::memcmp(value, all.value[std::size_t(std::countr_zero(rest))], width) != 0) return false;
  return true;
}

/// Returns how many values the brick has.
template <class Width>
std::size_t find_shares(const std::uint64_t* mask, ChannelBytes<const std::uint8_t> bytes, Width width,
                        std::uint8_t* share) {
  const BrickGroups all = compare_groups(mask, bytes, width);
  std::size_t values = 0;
  for (unsigned o = 0; o < 8; ++o) {
    const std::uint64_t octant = all.seen & std::uint64_t(0xff) << 8 * o;
    if (octant == 0) continue;
    share[o] = std::uint8_t((octant & ~all.mixed) >> 8 * o);
    if (are_alike(all, octant, width)) {
      share[8] |= std::uint8_t(1u << o);
      ++values;
      continue;
    }
    for (std::uint64_t rest = octant; rest != 0; rest &= rest - 1) {
      const unsigned g = unsigned(std::countr_zero(rest));
      values += (all.mixed >> g & 1) != 0 ? all.voxels[g] : 1;
    }
  }
  share[9] = all.seen == 0 || are_alike(all, all.seen, width) ? 1 : 0;
  return share[9] != 0 ? std::min<std::size_t>(values, 1) : values;
}

bool all_alike(ChannelBytes<const std::uint8_t> bytes, std::size_t width, std::size_t voxels) {
  for (std::size_t v = 1; v < voxels; ++v)
    if (std::memcmp(bytes[0], bytes[v], width) != 0) return false;
  return true;
}

void copy_values(ChannelBytes<const std::uint8_t> bytes, std::size_t width, std::size_t voxels,
                 const ParallelLoop& loop, std::vector<std::uint8_t>& value) {
  value.resize(voxels * width);
  with_known_width(width, [&](auto known) {
    loop(voxels, voxels_per_range, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) std::memcpy(&value[v * known], bytes[v], known);
    });
  });
}

}  // namespace

SharedValues share_values(std::span<const std::uint64_t> mask, std::span<const std::uint64_t> first,
                          ChannelBytes<const std::uint8_t> bytes, std::size_t width, const ParallelLoop& loop) {
  const std::size_t bricks = first.size() - 1, voxels = first.back();
  SharedValues out;
  if (voxels > 1 && all_alike(bytes, width, voxels)) {
    copy_values(bytes, width, 1, loop, out.value);
    return out;
  }
  out.share.resize(share_bytes * bricks);
  out.first.resize(bricks + 1);
  const auto brick_bytes = [&](std::size_t b) {
    return ChannelBytes<const std::uint8_t>{bytes[first[b]], bytes.stride};
  };
  loop(bricks, bricks_per_range, [&](std::size_t begin, std::size_t end) {
    with_known_width(width, [&](auto known) {
      for (std::size_t b = begin; b < end; ++b)
        out.first[b + 1] = find_shares(&mask[8 * b], brick_bytes(b), known, &out.share[share_bytes * b]);
    });
  });
  for (std::size_t b = 0; b < bricks; ++b) out.first[b + 1] += out.first[b];
  if (4 * (out.first.back() * width + (share_bytes + 2) * bricks) >= 3 * voxels * width) {
    out = {};
    copy_values(bytes, width, voxels, loop, out.value);
    return out;
  }
  out.value.resize(out.first.back() * width);
  loop(bricks, bricks_per_range, [&](std::size_t begin, std::size_t end) {
    with_known_width(width, [&](auto known) {
      for (std::size_t b = begin; b < end; ++b)
        for_each_value(&mask[8 * b], &out.share[share_bytes * b],
                       [&](std::size_t voxel, std::size_t value, bool is_new) {
                         const ChannelBytes<const std::uint8_t> brick = brick_bytes(b);
                         if (is_new) std::memcpy(&out.value[(out.first[b] + value) * known], brick[voxel], known);
                       });
    });
  });
  return out;
}

std::size_t count_values(const std::uint64_t* mask, const std::uint8_t* share) {
  return for_each_value(mask, share, [](std::size_t, std::size_t, bool) {});
}

bool spread_values(const std::uint64_t* mask, const std::uint8_t* share, std::span<const std::uint8_t> value,
                   std::size_t width, ChannelBytes<std::uint8_t> to) {
  const std::size_t values = value.size() / width;
  if (values == 0) return false;
  std::size_t count = 0;
  with_known_width(width, [&](auto known) {
    if (share[9] != 0) {  // most bricks of an opaque channel
      const std::size_t voxels = count_voxels(mask);
      for (std::size_t v = 0; v < voxels; ++v) std::memcpy(to[v], value.data(), known);
      count = 1;
      return;
    }
    count = for_each_value(mask, share, [&](std::size_t voxel, std::size_t number, bool) {
      std::memcpy(to[voxel], &value[std::min(number, values - 1) * known], known);
    });
  });
  return count == values;
}

}  // namespace gigabake
