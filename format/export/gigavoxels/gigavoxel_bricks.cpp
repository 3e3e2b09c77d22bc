#include "format/export/gigavoxels/gigavoxel_bricks.h"

#include <cerrno>
#include <cstring>
#include <functional>
#include <optional>
#include <unistd.h>

#include "core/base/error.h"
#include "format/export/gigavoxels/gigavoxel_read.h"

namespace gigabake {

/// The part of a brick's record before the colours.
struct GigavoxelBrickFile::Head {
  static constexpr std::uint64_t bytes = 3 * 8 + 3 * 4 + 2 * 4;
  static constexpr std::uint64_t maximum = 512;
  Vec3<std::uint64_t> size{};
  Vec3<std::uint32_t> border{};
  std::uint32_t compressed = 0, colour_bytes = 0;

  std::uint64_t voxels() const { return size[0] * size[1] * size[2]; }
  /// Returns the size of the whole record in bytes. Two words (8 bytes) precede the gradients.
  std::uint64_t record_bytes() const { return bytes + 8 + 7 * voxels(); }
};

GigavoxelBrickFile::GigavoxelBrickFile(const std::filesystem::path& path, const Vec3<std::uint32_t>& brick)
    : path_(path), file_(path, O_RDONLY), brick_(brick) {
  const off_t end = file_.is_open() ? ::lseek(file_.get(), 0, SEEK_END) : -1;
  if (end < 0) throw InputError(path, "", std::string("cannot read: ") + std::strerror(errno));
  bytes_ = std::uint64_t(end);
  std::uint32_t compressed = 0;
  read_at(0, &compressed, sizeof compressed);
  if (compressed != 0) throw InputError(path, "", "has S3TC bricks; expected uncompressed ones", 0);
  for (std::uint64_t at = sizeof compressed; at < bytes_;) {
    const std::uint64_t record = read_head(at).record_bytes();
    if (record > bytes_ - at) throw InputError(path, "", "ends within a brick", at);
    begin_.push_back(at);
    at += record;
  }
}

GigavoxelBrickFile::Head GigavoxelBrickFile::read_head(std::uint64_t at) const {
  Head head;
  read_at(at, &head.size, sizeof head.size);
  read_at(at + 24, &head.border, sizeof head.border);
  read_at(at + 36, &head.compressed, sizeof head.compressed);
  read_at(at + 40, &head.colour_bytes, sizeof head.colour_bytes);
  for (std::size_t c = 0; c < 3; ++c)
    if (head.size[c] > Head::maximum || head.border[c] > Head::maximum || head.border[c] + brick_[c] > head.size[c])
      throw InputError(path_, "", "a brick's size does not fit the tree's brick size and the border", at);
  if (head.compressed != 0) throw InputError(path_, "", "has an S3TC brick; expected uncompressed ones", at + 36);
  if (head.colour_bytes != 4 * head.voxels())
    throw InputError(path_, "", "expected four bytes of colour per voxel", at + 40);
  return head;
}

GigavoxelBrickData GigavoxelBrickFile::read(std::size_t number) const {
  if (number >= begin_.size())
    throw InputError(
        path_, "",
        "the tree refers to brick " + std::to_string(number) + ", the file has " + std::to_string(begin_.size()));
  const std::uint64_t at = begin_[number];
  const Head head = read_head(at);
  GigavoxelBrickData brick{head.size, head.border, std::vector<std::uint8_t>(4 * head.voxels()),
                           std::vector<std::uint8_t>(3 * head.voxels())};
  read_at(at + Head::bytes, brick.rgba.data(), brick.rgba.size());
  const std::uint64_t second = at + Head::bytes + brick.rgba.size();
  std::array<std::uint32_t, 2> gradient{};
  read_at(second, &gradient, sizeof gradient);
  if (gradient[0] != 0 || gradient[1] != brick.gradient.size())
    throw InputError(path_, "", "expected three uncompressed bytes of gradient per voxel", second);
  read_at(second + sizeof gradient, brick.gradient.data(), brick.gradient.size());
  return brick;
}

void GigavoxelBrickFile::read_at(std::uint64_t at, void* to, std::uint64_t bytes) const {
  if (at > bytes_ || bytes > bytes_ - at) throw InputError(path_, "", "ends early", bytes_);
  auto* out = static_cast<std::uint8_t*>(to);
  while (bytes > 0) {
    const ssize_t got = ::pread(file_.get(), out, bytes, off_t(at));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) throw InputError(path_, "", "cannot be read", at);
    out += got;
    at += std::uint64_t(got);
    bytes -= std::uint64_t(got);
  }
}

namespace {

class DepthWalk {
 public:
  using Visit = std::function<void(const GigavoxelBox&)>;
  DepthWalk(const GigavoxelTree& tree, std::uint32_t depth, const std::filesystem::path& bricks, const Visit& visit)
      : tree_(tree), depth_(depth), path_(bricks), visit_(visit) {}

  /// Visits the subtree of node `n`. `at` is the node's position in the grid of nodes of its depth.
  void walk(std::size_t n, std::uint32_t depth, const Vec3<std::uint64_t>& at) {
    const GigavoxelNode& node = tree_.nodes[n];
    if (depth == depth_ && !node.is_constant) return visit_brick(node, at);
    if (depth == depth_ || (node.child_block == 0 && node.is_constant)) return visit_constant(node, depth, at);
    for (std::size_t c = 0; c < 8 && node.child_block != 0; ++c)
      walk(8 * std::size_t(node.child_block) + c, depth + 1,
           {2 * at[0] + (c & 1), 2 * at[1] + (c >> 1 & 1), 2 * at[2] + (c >> 2)});
  }

 private:
  void visit_constant(const GigavoxelNode& node, std::uint32_t depth, const Vec3<std::uint64_t>& at) {
    if (node.value >> 24 == 0) return;
    GigavoxelBox box;
    box.extent = Vec3<std::uint64_t>(tree_.header.brick) << int(depth_ - depth);
    box.lowest = Vec3<std::uint64_t>::by_axis([&](int axis) { return at[axis] * box.extent[axis]; });
    for (std::size_t c = 0; c < 4; ++c) box.rgba[c] = std::uint8_t(node.value >> (8 * c));
    box.gradient = node.gradient;
    visit_(box);
  }

  void visit_brick(const GigavoxelNode& node, const Vec3<std::uint64_t>& at) {
    if (!file_) file_.emplace(path_, tree_.header.brick);
    const GigavoxelBrickData brick = file_->read(node.value);
    const auto& edge = tree_.header.brick;
    for (std::uint64_t z = 0; z < edge[2]; ++z)
      for (std::uint64_t y = 0; y < edge[1]; ++y)
        for (std::uint64_t x = 0; x < edge[0]; ++x) {
          const std::uint64_t row = (z + brick.border[2]) * brick.size[1] + y + brick.border[1];
          const std::uint64_t i = row * brick.size[0] + x + brick.border[0];
          if (brick.rgba[4 * i + 3] == 0) continue;
          GigavoxelBox box;
          box.lowest = {at[0] * edge[0] + x, at[1] * edge[1] + y, at[2] * edge[2] + z};
          std::memcpy(box.rgba.data(), &brick.rgba[4 * i], 4);
          std::memcpy(box.gradient.data(), &brick.gradient[3 * i], 3);
          visit_(box);
        }
  }

  const GigavoxelTree& tree_;
  std::uint32_t depth_;
  const std::filesystem::path& path_;
  const Visit& visit_;
  std::optional<GigavoxelBrickFile> file_;
};

}  // namespace

void for_each_gigavoxel(const GigavoxelTree& tree, std::uint32_t depth, const std::filesystem::path& bricks,
                        const std::function<void(const GigavoxelBox&)>& visit) {
  if (depth < tree.header.max_depth) DepthWalk(tree, depth, bricks, visit).walk(0, 0, {0, 0, 0});
}

}  // namespace gigabake
