/// Edits of a shown scene by its viewers: a preview, and the edit of the scene's files.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/math/box3.h"
#include "core/math/vec3.h"
#include "viewer/live/picked_point.h"
#include "viewer/pictures/picture.h"

namespace gigabake {

/// The voxels of lod 0 that an edit selects, before it is applied.
struct EditPreview {
  Box3i64 bounds;  ///< contains all selected voxels
  std::array<std::uint8_t, 3> rgb = {};
  std::function<bool(const Vec3i64& voxel)> selects;
};
using EditPreviews = std::vector<EditPreview>;

/// Tints the surfaces of the image that the edits select, and draws the edges of the edits' bounds. `rays` are the rays
/// of `picture`. Does not change depths.
/// Cost    Each thread takes 20 ns per edit and pixel in the rectangle around the image of the edit's bounds.
void draw_previews(Picture& picture, const PictureRays& rays, const EditPreviews& previews, const ThreadPool& pool);

/// The caller's way to edit a scene. `edits` is JSON such as {"edits": […]} (docs/editing.md). Thread-safe.
class SceneEditor {
 public:
  virtual ~SceneEditor() = default;
  /// Returns what the edits select on the lattice of `scene`.
  /// Errors  UsageError or InputError: a line that names the edit and the cause.
  virtual EditPreviews preview(const std::string& edits, const PictureRays& scene) const = 0;
  /// Applies the edits to the scene's files. Waits for its end.
  /// Errors  InputError: a line with the cause; the scene is unchanged.
  virtual void apply(const std::string& edits) = 0;
  /// Removes the last edit of the scene, like apply().
  virtual void undo() = 0;
};

}  // namespace gigabake
