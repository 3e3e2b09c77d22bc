#include "viewer/stream/exchange/edited_boxes.h"

#include <iterator>
#include <memory>

#include "core/base/error.h"
#include "format/edit/edited_fingerprint.h"
#include "format/edit/edits_file.h"

namespace gigabake {

std::optional<BakeParameters> parameters_of(const SceneHeader& scene) {
  try {
    return parameters_from_json(scene.parameters);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

std::string edits_text_of(const PagedScene& scene) {
  try {
    return read_edits_file(scene.folder());
  } catch (const InputError&) {
    return {};
  }
}

EditList voxel_edits_in(const PagedScene& scene, const std::string& text) {
  try {
    return voxel_edits(edits_of_file(scene.folder(), text));
  } catch (const UsageError&) {
    return {};
  }
}

EditedBoxes::EditedBoxes(const EditList& previous, const EditList& next, const SceneHeader& scene)
    : is_undo_(next.size() < previous.size()) {
  const EditList &shorter = is_undo_ ? next : previous, &longer = is_undo_ ? previous : next;
  if (longer.size() == shorter.size() || longer.size() - shorter.size() > max_edits) return;
  const std::optional<BakeParameters> parameters = parameters_of(scene);
  if (!parameters || parameters->max_error != 0 || parameters->depth_error != 0 || parameters->coarsest_lod != 0)
    return;
  const auto last = std::make_shared<const EditList>(longer.begin() + std::ssize(shorter), longer.end());
  try {
    edits_.emplace(last, scene.origin, SnapFrame{scene.voxel_size_m, scene.lattice_origin_m});
  } catch (const UsageError&) {
    edits_.reset();
  }
}

std::vector<Box3i64> EditedBoxes::of_cell(const SceneCell& before, const SceneCell& after) const {
  const Box3i64 cell = window_of(after);
  if (!edits_) return {cell};
  std::vector<Box3i64> boxes;
  Hash128 fingerprint = (is_undo_ ? after : before).fingerprint;
  for (const std::uint32_t e : edits_->selecting(cell)) {
    fingerprint = edited_fingerprint(fingerprint, edits_->hash(e));
    boxes.push_back(intersection(edits_->bounds(e), cell));
  }
  if (fingerprint != (is_undo_ ? before : after).fingerprint) return {cell};
  return boxes;
}

}  // namespace gigabake
