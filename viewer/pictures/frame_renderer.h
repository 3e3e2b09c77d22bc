/// One eye on one scene: frames for a window, a browser or files.
///
/// A frame is drawn from what is here; what its rays miss is asked for and comes in later frames, nearest first. Until
/// then the finest ancestor that is here stands for it. A frame that misses nothing is `complete` and then the same
/// bytes whatever the budgets, the path that led here and the number of threads.
///
/// Modes that show another property of voxels fill the pools anew.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "format/scene/paged_scene.h"
#include "lattice/progress.h"
#include "viewer/pictures/picture.h"
#include "viewer/pictures/view.h"
#include "viewer/stream/page.h"

namespace gigabake {

struct FrameStats {
  double cast_s = 0;          ///< rays
  double upload_s = 0;        ///< bricks and nodes into the pools
  double total_s = 0;         ///< the call
  std::uint64_t wanted = 0;   ///< bricks and node tiles that rays missed in this frame
  std::uint64_t uploads = 0;  ///< bricks and node tiles that came in for this frame
  std::uint64_t pages_loading = 0;
  std::uint64_t files_opened = 0;  ///< since the renderer opened the scene: its pages, and shards each time anew
  std::uint64_t bytes_held = 0, bytes_allowed = 0;  ///< pools and pages together; allowed: UINT64_MAX is no bound
  bool complete = false;
  bool starved = false;  ///< the pools are too small for what this view uses
};

struct Frame {
  Picture picture;
  FrameStats stats;
};

/// A full picture on its way: a value that whoever wants it keeps, so that several may be under way in turns.
struct FrameInTiles {
  View view;
  Picture picture;                       ///< final where tiles are done, elsewhere what stood there before
  std::vector<kernels::CastTile> tiles;  ///< from the middle outwards
  std::size_t done = 0;                  ///< of the tiles
  FrameStats stats;                      ///< times: sums so far

  bool is_complete() const { return done == tiles.size(); }
};

/// What one sketch() may take.
struct SketchLimits {
  double upload_s = 0.02;   ///< for new data; some always comes in
  double roots_s = 0;       ///< from when it starts, to wait while trees have no brick at all
  kernels::StopAsked stop;  ///< ends it: the frame is then of no use
};

class FrameRenderer {
 public:
  struct Options {
    int threads = 0;                                      ///< 0: all cores
    std::uint64_t memory_bytes = std::uint64_t(1) << 30;  ///< as SceneStream::Options, and so on
    std::optional<int> cuda_device;
    bool device_required = false;  ///< else the CPU casts where the device has too little memory left; see problems()
    std::uint64_t device_bytes = std::uint64_t(4) << 30;
    // Of lit pictures.
    double haze_visibility_m = HUGE_VAL;  ///< as air(); only before a sky
    double exposure_stops = 0;            ///< as screen_tone(); linear light stays as it is
  };

  /// Errors  InputError: no such scene, or one that lay_out_cells() refuses; UsageError: options out of range.
  FrameRenderer(const std::filesystem::path& scene_path, const Options& options);
  /// A scene whose pages come from elsewhere than its shards, through guarded_pages(). scene_path: for messages.
  FrameRenderer(const SceneDescription& scene, const std::filesystem::path& scene_path, const PageSource& pages,
                const Options& options);
  ~FrameRenderer();

  const PagedScene& scene() const;

  /// What camera options mean where eye or target are left open: the whole scene, from the south-east.
  /// Errors  as make_camera().
  CameraOptions framed(const CameraOptions& options) const;
  /// The rays of such a camera, in voxels.
  kernels::CastCamera rays_of(const CameraOptions& options) const;

  /// One pass of rays over what is here. upload_s: the time that new data may take out of the frame; some always comes
  /// in. Where the pools are too small for a view, the second frame of it is drawn as by draw_exact().
  /// Errors  UsageError: as make_camera(); ViewMode::slope of a scene without normals. Damaged shards are no error: see
  ///         problems().
  Frame draw(const View& view, double upload_s);

  /// As draw(), for an eye that moves: never exact where that would take long, and the roots of all trees come first,
  /// so that something stands for each of them.
  Frame sketch(const View& view, const SketchLimits& limits);

  /// As many passes as it takes: complete, whatever the pools hold.
  Frame draw_exact(const View& view, const Progress& progress = {});

  /// The same picture in pieces. meanwhile: a picture of the same view in any size, to stand where no tile is done yet;
  /// null: nothing does. go_on() does at least one tile, and others until `enough`, which is asked after each. stop:
  /// ends it within milliseconds, and the tile in hand is begun anew by the next call. Exact   As draw_exact(),
  /// whatever was stopped or drawn in between.
  FrameInTiles begin(const View& view, const Picture* meanwhile);
  void go_on(FrameInTiles& frame, const kernels::StopAsked& enough, const kernels::StopAsked& stop);

  /// One line for each shard that is missing or damaged, so far; its parts are drawn as their ancestors.
  std::vector<std::string> problems() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gigabake
