#include "kernels/cpu/voxelize/brick_sums.h"

#include <bit>

#include "core/octree/brick.h"

namespace gigabake::kernels {
namespace {

template <class Body>
void for_each_bit(const std::uint64_t mask[8], const Body& body) {
  for (int word = 0; word < 8; ++word)
    for (std::uint64_t rest = mask[word]; rest != 0; rest &= rest - 1) body(64 * word + std::countr_zero(rest));
}

}  // namespace

BrickSums::BrickSums(bool classes)
    : narrow_store_(std::make_unique<std::array<Narrow, brick_voxels>>()), narrow_(*narrow_store_) {
  if (classes) areas_.emplace();
}

void BrickSums::flush() {
  if (!wide_) wide_ = std::make_unique<std::array<Wide, brick_voxels>>();
  for_each_bit(mask_, [&](int voxel) {
    for (int s = 0; s < sum_count; ++s) (*wide_)[voxel][s] += narrow_[voxel][s];
    narrow_[voxel].fill(0);
  });
  triangles_ = 0;
  flushed_ = true;
}

void BrickSums::resolve_to(BrickRun& run, std::uint64_t key, const Tables& tables) {
  if (flushed_) flush();
  std::uint64_t visible[8] = {};
  std::array<Voxel, brick_voxels> voxels;
  std::array<DirectionalCoverage, brick_voxels> planes;
  std::size_t count = 0;
  std::vector<VoxelClass> classes = areas_ ? areas_->take_classes() : std::vector<VoxelClass>();
  for_each_bit(mask_, [&](int voxel) {
    FinestVoxel resolved;
    const bool there =
        flushed_ ? resolve((*wide_)[voxel].data(), tables, resolved) : resolve(narrow_[voxel].data(), tables, resolved);
    if (there) {
      if (!classes.empty()) classes[count] = classes[std::size_t(voxel)];
      voxels[count] = resolved.voxel;
      planes[count++] = {0, 0, 0, resolved.plane};
      visible[voxel >> 6] |= std::uint64_t(1) << (voxel & 63);
    }
    narrow_[voxel].fill(0);
    if (flushed_) (*wide_)[voxel].fill(0);
  });
  if (count != 0) {
    run.push_brick(key, visible, std::span(voxels).first(count));
    if (run.has_planes()) run.push_directional_coverage({planes[0].data(), directional_coverage_bytes * count});
    if (!classes.empty()) run.push_classes(std::span(classes).first(count));
  }
  for (std::uint64_t& word : mask_) word = 0;
  triangles_ = 0;
  flushed_ = false;
}

}  // namespace gigabake::kernels
