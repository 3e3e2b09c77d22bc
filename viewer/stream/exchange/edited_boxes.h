/// The parts of a scene that differ after edits of voxels. A viewer then exchanges these parts instead of whole cells.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/math/box3.h"
#include "core/octree/parameters.h"
#include "format/edit/edits_in_scene.h"
#include "format/scene/paged_scene.h"

namespace gigabake {

/// Returns the parameters of a scene's bake; nullopt if another version wrote them.
std::optional<BakeParameters> parameters_of(const SceneHeader& scene);

/// Returns the text of the list of edits in the folder of a scene; empty if it cannot be read.
std::string edits_text_of(const PagedScene& scene);
/// Returns the edits of voxels in such a text; none if it is no list of edits.
EditList voxel_edits_in(const PagedScene& scene, const std::string& text);

/// The edits that were added to a list of edits, or removed from its end.
class EditedBoxes {
 public:
  /// The max number of added or removed edits; with more, each changed cell counts as a whole.
  static constexpr std::size_t max_edits = 64;

  /// `previous` and `next` are the lists of two scenes with the lattice and the parameters of `scene`.
  EditedBoxes(const EditList& previous, const EditList& next, const SceneHeader& scene);

  /// Returns the boxes that contain all voxels of lod 0 that differ between a cell before and after. Voxels of coarser
  /// levels differ only above them. Returns the whole cell unless its fingerprints prove that only these edits lie
  /// between `before` and `after`.
  /// Range   Both are the same cell of the two scenes.
  std::vector<Box3i64> of_cell(const SceneCell& before, const SceneCell& after) const;

 private:
  bool is_undo_ = false;
  /// nullopt: none, too many, or voxels of the scene depend on others of their level or on the level of a source.
  std::optional<EditsInScene> edits_;
};

}  // namespace gigabake
