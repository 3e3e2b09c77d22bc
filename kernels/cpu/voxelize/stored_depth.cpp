#include "kernels/cpu/voxelize/stored_depth.h"

#include <algorithm>

#include "kernels/body/voxelize/occupies_brick.h"
#include "kernels/body/voxelize/window.h"

namespace gigabake::kernels {
namespace {

constexpr std::size_t triangles_per_task = 4096;

/// Returns the triangles of `lod` and coarser, in sub-voxels of that level. Coordinates are multiples of 2^lod, because
/// vertices are snapped to the level of their part.
std::vector<WindowTriangle> at_lod(std::span<const WindowTriangle> triangles, const std::vector<int>& lod_of_part,
                                   int lod) {
  std::vector<WindowTriangle> out;
  for (WindowTriangle t : triangles) {
    if (lod_of_part[t.part] < lod) continue;
    for (Vec3<std::int32_t>& p : t.p) p = p >> lod;
    out.push_back(t);
  }
  return out;
}

}  // namespace

int coarsest_lod(const CellInput& input) {
  int coarsest = 0;
  for (std::size_t p = 0; p < input.parts.size; ++p) coarsest = std::max(coarsest, input.parts[p].lod);
  return coarsest;
}

CellParameters at_level(const CellParameters& parameters, int lod) {
  CellParameters out = parameters;
  out.frame.voxel_size_m *= double(std::int64_t(1) << lod);
  out.window_min = parameters.window_min >> lod;
  out.window_voxels = parameters.window_voxels >> lod;
  out.edits = nullptr;
  out.kept = nullptr;
  return out;
}

StoredDepth::StoredDepth(const CellInput& input, std::span<const WindowTriangle> triangles,
                         const CellParameters& parameters, const ThreadPool& pool) {
  for (std::size_t p = 0; p < input.parts.size; ++p) lod_of_part_.push_back(input.parts[p].lod);
  const int levels = coarsest_lod(input) + 1;
  of_level_.resize(std::size_t(levels - 1));
  triangles_.push_back(triangles);
  for (int lod = 0; lod < levels; ++lod) {
    windows_.push_back(window_of(at_level(parameters, lod)));
    if (lod > 0) {
      of_level_[std::size_t(lod) - 1] = at_lod(triangles, lod_of_part_, lod);
      triangles_.emplace_back(of_level_[std::size_t(lod) - 1]);
    }
    refined_.emplace_back(std::uint64_t(1) << key_bits(windows_.back()));
    if (lod > 0) refined_.back().insert_parents_of(refined_[std::size_t(lod) - 1]);
    if (lod == 0 && parameters.edits != nullptr)
      parameters.edits->for_each_selected([this](std::uint64_t key) { refined_[0].insert(key); });
    add_occupied(lod, pool);
  }
}

/// Adds the bricks of level `lod` that triangles of this level occupy.
void StoredDepth::add_occupied(int lod, const ThreadPool& pool) {
  const std::span<const WindowTriangle> all = triangles_[std::size_t(lod)];
  const CellWindow& window = windows_[std::size_t(lod)];
  BrickSet& refined = refined_[std::size_t(lod)];
  pool.parallel_for(all.size(), triangles_per_task, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i) {
      if (lod_of_part_[all[i].part] != lod) continue;
      kernels::for_each_brick(all[i], window, [&](std::uint64_t key) {
        if (!refined.contains_now(key) && occupies_brick(all[i], key, window.rule)) refined.insert(key);
      });
    }
  });
}

VoxelMask StoredDepth::own_voxels(std::uint64_t key, int lod) const {
  const unsigned refined = lod == 0 ? 0 : refined_[std::size_t(lod) - 1].children(key);
  VoxelMask own;
  for (unsigned z = 0; z < own.size(); ++z) own[z] = ~octant_word(refined, z);
  return own;
}

std::uint64_t StoredDepth::bytes() const {
  std::uint64_t bytes = 0;
  for (const BrickSet& set : refined_) bytes += set.bytes();
  for (const auto& triangles : of_level_) bytes += triangles.size() * sizeof(WindowTriangle);
  return bytes;
}

}  // namespace gigabake::kernels
