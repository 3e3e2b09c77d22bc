/// Renderer of one scene: frames for a window, a browser or files.
///
/// A frame is rendered from resident data. Its rays request missing data, which is uploaded for later frames, the
/// nearest data first. Until then the finest resident ancestor replaces this data. A frame that misses no data is
/// `complete`. The bytes of a complete frame do not depend on budgets, earlier frames or the number of threads.
///
/// A change to a mode that shows another property of voxels refills the pools.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/base/thread_pool.h"
#include "format/scene/paged_scene.h"
#include "viewer/pictures/picture.h"
#include "viewer/pictures/view.h"
#include "viewer/stream/page.h"

namespace gigabake {

struct FrameStats {
  double cast_s = 0;            ///< casting of rays
  double upload_s = 0;          ///< upload of bricks and nodes to the pools
  double total_s = 0;           ///< the whole call
  std::uint64_t requested = 0;  ///< bricks and node tiles (8 sibling nodes) that rays missed in this frame
  std::uint64_t uploads = 0;    ///< bricks and node tiles uploaded for this frame
  std::uint64_t pages_loading = 0;
  std::uint64_t passes = 0;        ///< passes of rays over tiles, or over the whole frame
  std::uint64_t page_waits = 0;    ///< waits for pages that were requested after the latest pass of rays
  std::uint64_t files_opened = 0;  ///< page and shard files that this renderer has opened so far
  std::uint64_t bytes_held = 0, bytes_allowed = 0;  ///< of pools and pages; bytes_allowed: UINT64_MAX means unbounded
  bool complete = false;
  bool starved = false;  ///< the pools are smaller than the working set of this view
};

struct Frame {
  Picture picture;
  FrameStats stats;
};

/// An image that is rendered in tiles. The caller owns this value, so several images can be rendered alternately.
struct ProgressiveFrame {
  View view;
  Picture picture;                       ///< final in finished tiles; the initial image elsewhere
  std::vector<kernels::CastTile> tiles;  ///< from the middle outwards
  std::size_t done = 0;                  ///< number of finished tiles
  FrameStats stats;                      ///< times are sums so far

  bool is_complete() const { return done == tiles.size(); }
};

/// The time limits of one call of render_preview().
struct PreviewLimits {
  double upload_s = 0.02;   ///< max. time for uploads; some data is always uploaded
  double roots_s = 0;       ///< max. wait at the start for the root bricks of all trees
  kernels::StopAsked stop;  ///< cancels the call; the frame is then unusable
};

class FrameRenderer {
 public:
  struct Options {
    int threads = 0;                                      ///< 0: all cores
    std::uint64_t memory_bytes = std::uint64_t(1) << 30;  ///< see SceneStream::Options for this and device_bytes
    std::optional<int> cuda_device;
    bool device_required = false;  ///< false: if the device fails, the CPU casts rays; see problems()
    std::uint64_t device_bytes = std::uint64_t(4) << 30;
    // These members affect only modes that show light.
    double haze_visibility_m = HUGE_VAL;  ///< visibility for air(); only in ViewMode::lit with a sky
    double exposure_stops = 0;            ///< exposure for screen_tone(); linear light is not scaled
  };

  /// Opens the scene.
  /// Errors  InputError: the scene does not exist, or lay_out_cells() rejects it. UsageError: options out of range.
  FrameRenderer(const std::filesystem::path& scene_path, const Options& options);
  /// Opens a scene whose pages come from `pages` instead of its shards. guarded_pages() checks the pages. `scene_path`
  /// is used only in messages.
  FrameRenderer(const SceneDescription& scene, const std::filesystem::path& scene_path, const PageSource& pages,
                const Options& options);
  /// Opens a scene whose shards appear while it is shown (format/scene/scene_watch.h).
  FrameRenderer(const std::filesystem::path& scene_path, const SceneDescription& watched, const Options& options);
  ~FrameRenderer();

  const PagedScene& scene() const;
  /// Returns the pool of the renderer's threads.
  const ThreadPool& pool() const;

  /// Begins to exchange the shards of a watched scene's cells. `cells` are the numbers in `watched`, whose places are
  /// unchanged.
  void replace_shards(const std::vector<SceneCell>& watched, const std::vector<std::uint32_t>& cells);
  /// Begins to exchange the scene for the scene that the file describes now. Pages and bricks of shards with equal
  /// content stay. Returns false if the scene must be opened again because its lattice, channels or layout differ.
  /// Errors  InputError: the scene is unreadable.
  bool replace_scene();
  /// Returns whether an exchange is in progress. Images show the previous contents until it is complete.
  bool has_exchange() const;
  /// Continues the exchange for at most `upload_s`. Returns true once it is complete. Images that begin() has started
  /// must then be started again.
  bool advance_exchange(double upload_s);
  /// Returns the number of bricks and node tiles that were uploaded so far.
  std::uint64_t uploads() const;
  /// Returns the bytes of these bricks and nodes in the pools, when they were uploaded.
  std::uint64_t uploaded_bytes() const;

  /// Returns the options with eye and target set; their defaults show the whole scene from the south-east.
  /// Errors  The same as make_camera().
  CameraOptions framed(const CameraOptions& options) const;
  /// Returns the camera of `options` in lod-0 voxels.
  kernels::CastCamera rays_of(const CameraOptions& options) const;

  /// Renders a frame in one pass over resident data. `upload_s` is the maximum time for uploads; some data is always
  /// uploaded. If the pools are too small for the view, its next frames are rendered by render_complete().
  /// Errors  UsageError: the errors of make_camera(); ViewMode::slope for a scene without normals,
  ///         ViewMode::voxel_class for one without classes. Damaged shards cause
  ///         no exception: see problems().
  Frame draw(const View& view, double upload_s);

  /// Renders a preview for a moving eye, never by render_complete(). The roots of all trees are uploaded first, so that
  /// each tree has a fallback.
  Frame render_preview(const View& view, const PreviewLimits& limits);

  /// Renders the complete image in as many passes as necessary, whatever the size of the pools.
  Frame render_complete(const View& view, const Progress& progress = {});

  /// Starts an image in tiles that equals the image of render_complete(). Unfinished tiles show `meanwhile`, an image
  /// of the same view in any size; null: they are transparent.
  ProgressiveFrame begin(const View& view, const Picture* meanwhile);
  /// Renders at least one tile, then further tiles until `enough` returns true. Calls `enough` after each tile. `stop`
  /// cancels within milliseconds; the next call restarts the unfinished tile.
  /// Exact   The finished image equals the image of render_complete(), also after cancelled calls and other renderings
  ///         in between.
  void resume(ProgressiveFrame& frame, const kernels::StopAsked& enough, const kernels::StopAsked& stop);

  /// Returns one line for each page that could not be read, and one if the CPU replaces a failed device. The image
  /// shows the ancestors of unreadable data.
  std::vector<std::string> problems() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gigabake
