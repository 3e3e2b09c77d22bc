#include "viewer/query/query_tree.h"

#include <algorithm>
#include <stdexcept>

#include "core/base/error.h"
#include "format/scene/shard_of_scene.h"
#include "kernels/first_hit/first_hit.h"

namespace gigabake {
namespace {

/// Rim as a fraction of the tree's edge: twice the error of the traversal relative to the exact ray. The rim is added
/// on both sides of a face between windows.
constexpr double rim = 0x1p-19;

/// Memory while a tree is built, measured on surfaces. Voxel: its columns, its attributes twice (vector growth), and
/// its fraction of the nodes. Brick: a mask and up to eight nodes, three times. Constant: 64 attributes and a node.
constexpr std::uint64_t bytes_per_voxel = 26, bytes_per_brick = 600, bytes_per_constant = 1200, bytes_of_all = 1u << 16;

}  // namespace

QueryTreeSource::QueryTreeSource(const PagedScene& scene, const SceneCell& shard, int lod)
    : path_(scene.folder() / shard.file),
      shard_(shard),
      shard_lod_(lod - int(shard.first_lod)),
      reader_(open_shard_of_scene(scene.file(), scene.header(), shard)),
      nodes_(reader_.nodes()) {
  std::uint64_t in_constants = 0;
  for (std::size_t n = 0; n < nodes_.lod.size(); ++n) {
    const int above = int(nodes_.lod[n]) - shard_lod_;
    if (above == 0 && nodes_.kind[n] == NodeKind::brick) {
      ++bricks_;
    } else if (above == 0 || (above > 0 && nodes_.kind[n] == NodeKind::leaf_constant)) {
      ++constants_;
      in_constants += std::uint64_t(brick_voxels) << (3 * above);
    }
  }
  const std::uint64_t voxels =
      std::size_t(shard_lod_) < shard.voxels.size() ? shard.voxels[std::size_t(shard_lod_)] : 0;
  stored_voxels_ = std::min(voxels - std::min(voxels, in_constants), bricks_ * brick_voxels);
}

std::uint64_t QueryTreeSource::bytes_to_build() const {
  return stored_voxels_ * bytes_per_voxel + bricks_ * bytes_per_brick + constants_ * bytes_per_constant + bytes_of_all;
}

QueryTree::QueryTree(const QueryTreeSource& source)
    : unit_(kernels::power_of_two(int(source.shard_.first_lod))),
      half_window_(0.5 * source.shard_.cell_voxels / unit_),
      lod_(int(source.shard_.first_lod) + source.shard_lod_) {
  for (std::size_t a = 0; a < 3; ++a) {
    corner_[a] = window_.min[a] = source.shard_.lattice_min[a];
    window_.max[a] = corner_[a] + source.shard_.cell_voxels;
  }
  try {
    FirstHitBuilder builder(source.shard_lod_);
    builder.add_cell({0, 0, 0}, source.nodes_, source.reader_.level(source.shard_lod_));
    scene_ = builder.finish_window(std::int64_t(source.shard_.cell_voxels) >> lod_);
    grown_ = 1 + rim * double(scene_.view.tree.edge) / half_window_;
  } catch (const std::invalid_argument& error) {
    throw InputError(source.path_, "", error.what());
  } catch (const std::length_error& error) {
    throw InputError(source.path_, "", error.what());
  }
}

std::optional<QueryHit> QueryTree::first_hit(const QueryRay& ray, double from, double to, std::uint32_t shard) const {
  const double voxel = kernels::power_of_two(lod_);
  RayChord chord = chord_of(ray, window_, voxel);
  chord = {std::fmax(chord.enter, from), std::fmin(chord.leave, to)};
  if (chord.empty()) return {};
  // Start where the ray enters the window, so that single precision suffices inside.
  kernels::FirstHitRay local;
  for (int a = 0; a < 3; ++a) {
    const double p = ray.origin[a] + ray.direction[a] * chord.enter - double(corner_[a]);
    local.origin[a] = half_window_ + (p / unit_ - half_window_) / grown_;
    local.direction[a] = float(ray.direction[a]);
  }
  local.end = float((chord.leave - chord.enter) / (unit_ * grown_));
  std::uint32_t slots[kernels::first_hit_stack];
  const kernels::FirstHit found = kernels::first_hit(scene_.view.tree, local, 0, kernels::FirstHitSlots<1>{slots});
  if (found.look == kernels::no_attributes) return {};
  QueryHit hit;
  hit.outcome = QueryOutcome::hit;
  hit.lod = lod_;
  hit.shard = shard;
  kernels::VoxelBox box;
  for (int a = 0; a < 3; ++a) {
    const auto at = std::int64_t(found.voxel >> 21 * a & 0x1fffff) << scene_.lod;
    hit.voxel[a] = corner_[a] + (scene_.lattice_min[std::size_t(a)] + at) * std::int64_t(unit_);
    box.min[a] = hit.voxel[a];
    box.max[a] = hit.voxel[a] + std::int64_t(voxel);
  }
  const RayChord exact = chord_of(ray, box, 0);
  const double rough = chord.enter + double(found.distance) * unit_ * grown_;
  hit.distance = std::fmin(std::fmax(exact.empty() ? rough : exact.enter, from), to);
  const kernels::VoxelAttributes& look = scene_.looks[found.look];
  hit.rgba = look.rgba;
  hit.normal[0] = look.normal[0];
  hit.normal[1] = look.normal[1];
  return hit;
}

}  // namespace gigabake
