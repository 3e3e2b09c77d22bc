#include "format/shard/columns/channel_rows.h"

#include <bit>
#include <cstring>
#include <vector>

#include "format/shard/check/broken_rule.h"
#include "format/shard/columns/shared_values.h"

namespace gigabake {
namespace {

template <class T>
std::vector<T> read_rows(const StoredRows& rows, std::uint64_t first, std::uint64_t count, std::size_t width) {
  std::vector<T> out(count * width);
  rows.read(first, count, out.data());
  return out;
}

}  // namespace

ChannelRows::ChannelRows(const ColumnSource& source, const std::string& group, const VoxelChannel& channel,
                         std::uint64_t bricks, std::uint64_t voxels)
    : source_(source),
      channel_(channel),
      columns_(group, channel),
      value_(source.open(columns_.value)),
      voxels_(voxels) {
  if (!source.has(columns_.share)) {
    if (value_->rows() != voxels && (value_->rows() != 1 || voxels == 0))
      throw InputError(source.path(), group, std::string(channel.name) + " does not match first");
    return;
  }
  share_ = source.open(columns_.share);
  first_ = source.open(columns_.first);
  if (share_->rows() != bricks || first_->rows() != bricks + 1)
    throw InputError(source.path(), group, std::string(channel.name) + " is shared by the wrong number of bricks");
}

void ChannelRows::read(std::uint64_t brick, std::span<const std::uint64_t> mask, std::uint64_t first_voxel,
                       std::uint64_t voxels, ChannelBytes<std::uint8_t> to) const {
  if (share_) return read_shared(brick, mask, to);
  const std::size_t width = channel_.width;
  const bool is_constant = value_->rows() != voxels_;
  if (!is_constant && width == to.stride) return value_->read(first_voxel, voxels, to.first);
  const auto value = read_rows<std::uint8_t>(*value_, is_constant ? 0 : first_voxel, is_constant ? 1 : voxels, width);
  with_known_width(width, [&](auto known) {
    for (std::size_t v = 0; v < voxels; ++v) std::memcpy(to[v], value.data() + (is_constant ? 0 : v * known), known);
  });
}

void ChannelRows::read_shared(std::uint64_t brick, std::span<const std::uint64_t> mask,
                              ChannelBytes<std::uint8_t> to) const {
  const std::size_t bricks = mask.size() / 8, width = channel_.width;
  const auto share = read_rows<std::uint8_t>(*share_, brick, bricks, share_bytes);
  const auto first = read_rows<std::uint64_t>(*first_, brick, bricks + 1, 1);
  const BrokenRule table{source_.path(), columns_.first.name};
  table.expect(brick > 0 || first[0] == 0, 0, "does not begin at 0");
  for (std::size_t b = 0; b < bricks; ++b)
    table.expect(first[b + 1] > first[b] && first[b + 1] - first[b] <= brick_voxels, brick + b,
                 "does not count the shared values");
  table.expect(
      first.back() <= value_->rows() && (brick + bricks + 1 < first_->rows() || first.back() == value_->rows()),
      brick + bricks, "does not end at the number of values");
  const auto value = read_rows<std::uint8_t>(*value_, first[0], first.back() - first[0], width);
  std::size_t voxel = 0;
  for (std::size_t b = 0; b < bricks; ++b) {
    const std::span values(value.data() + (first[b] - first[0]) * width, (first[b + 1] - first[b]) * width);
    const bool fits = spread_values(&mask[8 * b], &share[share_bytes * b], values, width, {to[voxel], to.stride});
    table.expect(fits && share[share_bytes * b + 9] <= 1, brick + b, "does not count the shared values");
    for (std::size_t w = 0; w < 8; ++w) voxel += std::size_t(std::popcount(mask[8 * b + w]));
  }
}

}  // namespace gigabake
