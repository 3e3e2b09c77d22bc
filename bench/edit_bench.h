/// Times the edits of a brush in an interactive viewer: preview, files, and the images that show the edited scene.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "viewer/live/scene_editor.h"
#include "viewer/pictures/frame_renderer.h"

namespace gigabake::bench {

struct EditBenchRequest {
  std::filesystem::path scene;  ///< scene.xml of a bake
  std::shared_ptr<SceneEditor> editor;
  int width = 1280, height = 720;
  double brush_voxels = 32;      ///< diameter of the brush, a sphere
  double distance_voxels = 400;  ///< from the eye to the edited surface
  int repeats = 3;               ///< edits per type
  FrameRenderer::Options renderer;
};

/// Times from the start of the call, in seconds; each is the median of the repeats.
struct EditBenchRow {
  std::string type;
  double preview_s = 0;       ///< LiveScene::preview() until an image with the preview is published
  double disk_s = 0;          ///< LiveScene::edit() until the new scene is on disk
  double image_s = 0;         ///< LiveScene::edit() until an image, of any size, shows the new scene
  double rest_s = 0;          ///< LiveScene::edit() until the complete image at full size
  double undo_s = 0;          ///< the same as disk_s, of the undo
  std::uint64_t uploads = 0;  ///< bricks and lists of children that the viewer uploaded for the edit
};

struct EditBench {
  int width = 0, height = 0;
  double brush_voxels = 0;
  std::vector<EditBenchRow> rows;
  bool same_as_rendered = true;  ///< each complete image equals that of a new renderer
  bool is_restored = true;       ///< the image after all undos equals the first

  bool failed() const { return !same_as_rendered || !is_restored; }
};

/// Paints, carves and fills the surface in the middle of the scene, and undoes each edit. The scene is then the same as
/// before, unless an error ends the measurement. Shards of the edits remain in its folder, so a second measurement of
/// the scene finds them: remove them first (`bake --prune`).
/// Errors  See FrameRenderer and SceneEditor. InputError: no surface is seen, or no image arrives.
EditBench bench_edits(const EditBenchRequest& request);

}  // namespace gigabake::bench
