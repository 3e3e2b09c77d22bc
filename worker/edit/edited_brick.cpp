#include "worker/edit/edited_brick.h"

#include <algorithm>
#include <bit>

#include "worker/edit/fill_surface.h"

namespace gigabake {
namespace {

constexpr std::size_t mask_words = 8, word_voxels = 64;

}  // namespace

template <class Visit>
void EditedBrick::for_each(const BrickMask& mask, const Visit& visit) {
  for (std::size_t w = 0; w < mask_words; ++w)
    for (std::uint64_t left = mask[w]; left != 0; left &= left - 1)
      visit(w, std::size_t(std::countr_zero(left)), word_voxels * w + std::size_t(std::countr_zero(left)));
}

void EditedBrick::load(const kernels::Level& level, std::size_t index) {
  std::copy_n(level.mask.begin() + std::ptrdiff_t(mask_words * index), mask_words, mask_.begin());
  std::uint64_t from = level.first[index];
  for_each(mask_, [&](std::size_t, std::size_t, std::size_t i) {
    Voxel& v = voxels_[i];
    v = {};
    std::copy_n(&level.rgba[4 * from], 4, v.rgba.begin());
    if (!level.normal.empty()) std::copy_n(&level.normal[2 * from], 2, v.normal.begin());
    if (!level.directional_coverage.empty())
      v.plane = level.directional_coverage[directional_coverage_bytes * from + directional_coverage_plane];
    if (!level.voxel_class.empty()) v.voxel_class = level.voxel_class[from];
    ++from;
  });
}

/// Returns the voxels of the brick that an edit selects.
BrickMask EditedBrick::selected_by(std::uint32_t edit) const {
  BrickMask mask{};
  const AreaOverlap whole = edits_.overlap(edit, Box3i64::cube(min_, brick_edge));
  if (whole == AreaOverlap::inside) mask.fill(~std::uint64_t(0));
  return whole == AreaOverlap::border ? edits_.selected(edit, min_) : mask;
}

bool EditedBrick::apply(std::span<const std::uint32_t> edits) {
  bool is_changed = false;
  for (const std::uint32_t e : edits) {
    const Edit& edit = edits_.edit(e);
    if (edit.type != EditType::fill && mask_ == BrickMask{}) continue;
    const BrickMask selected = selected_by(e);
    if (selected == BrickMask{}) continue;
    is_changed = true;
    if (edit.type == EditType::fill) fill(e, selected);
    if (edit.type == EditType::paint) paint(edit, selected);
    if (edit.type == EditType::carve)
      for (std::size_t w = 0; w < mask_words; ++w) mask_[w] &= ~selected[w];
  }
  return is_changed;
}

void EditedBrick::fill(std::uint32_t edit, const BrickMask& selected) {
  const Edit& by = edits_.edit(edit);
  const FilledBrick filled(edits_, edit, min_, selected);
  for_each(selected, [&](std::size_t z, std::size_t bit, std::size_t i) {
    const FilledSurface surface = filled.surface({int(bit) % brick_edge, int(bit) / brick_edge, int(z)});
    voxels_[i] = {
        {by.rgb[0], by.rgb[1], by.rgb[2], 255}, surface.normal, surface.plane, by.voxel_class.value_or(no_class)};
  });
  for (std::size_t w = 0; w < mask_words; ++w) mask_[w] |= selected[w];
}

void EditedBrick::paint(const Edit& edit, const BrickMask& selected) {
  BrickMask painted;
  for (std::size_t w = 0; w < mask_words; ++w) painted[w] = mask_[w] & selected[w];
  for_each(painted, [&](std::size_t, std::size_t, std::size_t i) {
    Voxel& v = voxels_[i];
    if (edit.has_rgb) std::copy_n(edit.rgb.begin(), 3, v.rgba.begin());
    if (edit.alpha) v.rgba[3] = *edit.alpha;
    if (edit.voxel_class) v.voxel_class = *edit.voxel_class;
    if (v.rgba[3] != 255) v.plane = 0;
  });
}

void EditedBrick::append_to(kernels::Level& level, std::uint64_t key) const {
  if (mask_ == BrickMask{}) return;
  if (level.first.empty()) level.first.push_back(0);
  std::uint64_t voxels = level.first.back();
  const bool has_planes = kernels::has_finest_planes(parameters_);
  for_each(mask_, [&](std::size_t, std::size_t, std::size_t i) {
    const Voxel& v = voxels_[i];
    level.rgba.insert(level.rgba.end(), v.rgba.begin(), v.rgba.end());
    if (parameters_.normals) level.normal.insert(level.normal.end(), v.normal.begin(), v.normal.end());
    if (has_planes) level.directional_coverage.insert(level.directional_coverage.end(), {0, 0, 0, v.plane});
    if (parameters_.classes) level.voxel_class.push_back(v.voxel_class);
    ++voxels;
  });
  level.key.push_back(key);
  level.mask.insert(level.mask.end(), mask_.begin(), mask_.end());
  level.first.push_back(voxels);
}

}  // namespace gigabake
