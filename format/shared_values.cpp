#include "format/shared_values.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "format/parallel.h"

namespace gigabake {
namespace {

constexpr std::size_t groups = 64, bricks_per_range = 2048;
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

/// The voxels of a group, octant or brick seen so far.
struct Alike {
  const std::uint8_t* value = nullptr;  ///< of the first voxel
  bool holds = true;

  template <class Width>
  void add(const std::uint8_t* other, bool others_hold, Width width) {
    if (value == nullptr) value = other;
    holds &= others_hold && std::memcmp(value, other, width) == 0;
  }
};

void find_shares(const std::uint64_t* mask, ChannelBytes<const std::uint8_t> bytes, std::size_t width,
                 std::uint8_t* share) {
  std::array<Alike, groups> group{};
  with_known_width(width, [&](auto known) {
    std::size_t voxel = 0;
    for_each_group_of_voxels(mask, [&](std::uint8_t g) { group[g].add(bytes[voxel++], true, known); });
  });
  Alike brick;
  for (unsigned o = 0; o < 8; ++o) {
    Alike octant;
    for (unsigned g = 0; g < 8; ++g) {
      const Alike& of_group = group[8 * o + g];
      if (of_group.value == nullptr) continue;
      if (of_group.holds) share[o] |= std::uint8_t(1u << g);
      octant.add(of_group.value, of_group.holds, width);
    }
    if (octant.value == nullptr) continue;
    if (octant.holds) share[8] |= std::uint8_t(1u << o);
    brick.add(octant.value, octant.holds, width);
  }
  share[9] = brick.holds ? 1 : 0;
}

bool all_alike(ChannelBytes<const std::uint8_t> bytes, std::size_t width, std::size_t voxels) {
  for (std::size_t v = 1; v < voxels; ++v)
    if (std::memcmp(bytes[0], bytes[v], width) != 0) return false;
  return true;
}

void copy_values(ChannelBytes<const std::uint8_t> bytes, std::size_t width, std::size_t voxels,
                 std::vector<std::uint8_t>& value) {
  value.resize(voxels * width);
  with_known_width(width, [&](auto known) {
    for (std::size_t v = 0; v < voxels; ++v) std::memcpy(&value[v * known], bytes[v], known);
  });
}

}  // namespace

SharedValues share_values(std::span<const std::uint64_t> mask, std::span<const std::uint64_t> first,
                          ChannelBytes<const std::uint8_t> bytes, std::size_t width, int threads) {
  const std::size_t bricks = first.size() - 1, voxels = first.back();
  SharedValues out;
  if (voxels > 1 && all_alike(bytes, width, voxels)) {
    copy_values(bytes, width, 1, out.value);
    return out;
  }
  out.share.resize(share_bytes * bricks);
  out.first.resize(bricks + 1);
  const auto brick_bytes = [&](std::size_t b) {
    return ChannelBytes<const std::uint8_t>{bytes[first[b]], bytes.stride};
  };
  parallel_ranges(bricks, bricks_per_range, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      find_shares(&mask[8 * b], brick_bytes(b), width, &out.share[share_bytes * b]);
      out.first[b + 1] = count_values(&mask[8 * b], &out.share[share_bytes * b]);
    }
  });
  for (std::size_t b = 0; b < bricks; ++b) out.first[b + 1] += out.first[b];
  if (4 * (out.first.back() * width + (share_bytes + 2) * bricks) >= 3 * voxels * width) {
    out = {};
    copy_values(bytes, width, voxels, out.value);
    return out;
  }
  out.value.resize(out.first.back() * width);
  parallel_ranges(bricks, bricks_per_range, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b)
      for_each_value(&mask[8 * b], &out.share[share_bytes * b], [&](std::size_t voxel, std::size_t value, bool is_new) {
        if (is_new) std::copy_n(brick_bytes(b)[voxel], width, &out.value[(out.first[b] + value) * width]);
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
