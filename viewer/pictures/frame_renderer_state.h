/// The state of a FrameRenderer: its scene, the scene that replaces it, and the passes of a frame. Only
/// frame_renderer.cpp includes this file.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <utility>

#include "core/base/error.h"
#include "format/shard/hdf5/chunk_cache.h"
#include "format/system/host_limits.h"
#include "viewer/pictures/frame_renderer.h"
#include "viewer/pictures/render.h"
#include "viewer/pictures/view_needs.h"
#include "viewer/stream/exchange/paged_shards.h"
#include "viewer/stream/exchange/scene_changes.h"
#include "viewer/stream/exchange/shard_table.h"
#include "viewer/stream/open_shards.h"
#include "viewer/stream/page.h"

namespace gigabake {

/// A scene that will replace the shown scene in the same pools.
struct NextScene {
  std::shared_ptr<const PagedScene> scene;
  ShardNumbers numbers;
  std::vector<Box3i64> changed;
  std::string edits;  ///< text of the list of edits in its folder
};

struct FrameRenderer::State {
  using Clock = std::chrono::steady_clock;

  static double since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

  static Clock::time_point from_now(double seconds) {
    return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  }

  static kernels::StopAsked after(double seconds) {
    return [end = from_now(seconds)] { return Clock::now() >= end; };
  }

  static bool is_asked(const kernels::StopAsked& stop) { return stop && stop(); }

  /// The working set of a view counts as larger than the memory budget if the view has read this multiple of it.
  static constexpr std::uint64_t max_page_reread_factor = 4;

  /// The max number of requests of the last frame with which rays wait for uploads. Answering this many takes some
  /// milliseconds on 16 cores.
  static constexpr std::size_t max_awaited_requests = 8192;

  Options options;
  std::shared_ptr<const PagedScene> scene;
  std::shared_ptr<std::atomic<std::uint64_t>> files_opened = std::make_shared<std::atomic<std::uint64_t>>(0);
  ThreadPool policy;
  std::shared_ptr<ShardTable> table;         ///< null if the scene has pages, or an external source
  std::shared_ptr<PagedShards> paged_table;  ///< null if the scene has no pages, or an external source
  ShardNumbers numbers;                      ///< of `scene` in one of the tables
  std::string edits;                         ///< text of the list of edits in the folder of `scene`
  PageSource source;
  Filling filling{};
  std::unique_ptr<SceneStream> stream;
  std::vector<std::uint32_t> requested;  ///< requests of the last frame
  View last;
  std::uint32_t frame_pass = 0;         ///< first pass of the last frame
  bool put_in = false;                  ///< the last put_in_wanted() uploaded data
  bool was_complete = false;            ///< no ray of the last frame missed data
  double upload_s = 0;                  ///< time of uploads in this frame
  double waited_s = 0;                  ///< time of the wait for roots at the start of this frame
  std::uint64_t bytes_read_before = 0;  ///< bytes that the stream had read before `last` was first rendered
  bool starved = false;
  std::optional<NextScene> next;      ///< of the exchange in progress
  std::vector<std::string> problems;  ///< in addition to problems of pages
  PolygonPictures polygons;
  std::optional<HeightRange> heights;  ///< of the scene; set at the first view that needs them

  State(std::shared_ptr<const PagedScene> opened, const PageSource& pages, const Options& wishes)
      : options(wishes), scene(std::move(opened)), policy(threads_of(wishes)) {
    if (pages) {
      source = guarded_pages(pages, scene->header());
      fill(filling_of({}));
      return;
    }
    edits = edits_text_of(*scene);
    const auto chunks = std::make_shared<ChunkCache>(chunk_bytes(wishes));
    if (scene->root().pages.empty()) {
      table = std::make_shared<ShardTable>(*scene, max_open(wishes), files_opened, chunks);
      numbers = table->add_all(*scene);
      source = [all = table](const PageKey& key) { return all->page(key); };
    } else {
      paged_table = std::make_shared<PagedShards>(scene, max_open(wishes), files_opened, chunks);
      source = [all = paged_table](const PageKey& key) { return all->page(key); };
    }
    fill(filling_of({}));
  }

  static int threads_of(const Options& wishes) {
    if (wishes.threads < 0 || wishes.threads > 1024)
      throw UsageError("threads", "expected 1 to 1024, or 0 for all cores");
    return wishes.threads > 0 ? wishes.threads : host_limits().cores();
  }

  static std::uint64_t memory_of(const Options& wishes) {
    return std::min(wishes.memory_bytes, host_limits().memory_bytes / 2);
  }
  /// Returns the memory for unpacked chunks of shards. More than the limit saves little: neighbouring pages need the
  /// same chunks within a short time.
  static std::uint64_t chunk_bytes(const Options& wishes) {
    return std::min(memory_of(wishes) / 32, std::uint64_t(32) << 20);
  }
  static std::size_t max_open(const Options& wishes) { return open_shards_within(memory_of(wishes)); }

  /// Returns the memory for pools and pages. The open shards reduce it by at most 1/8, and their chunks by 1/32. A
  /// scene can have fewer shards than the limit of open shards.
  std::uint64_t bytes_next_to_shards() const {
    const std::uint64_t shards = scene->totals().cells + scene->totals().overviews, all = memory_of(options);
    const std::uint64_t open = std::min<std::uint64_t>(max_open(options), shards) * open_shard_bytes;
    return all - std::min(open, all / 8) - chunk_bytes(options) - bytes_for_rays();
  }

  /// Returns the memory for the rays of a large tile on the CPU. It grows with the number of threads, because caches of
  /// few cores hold few rays. Returns 0 if the pools need all memory: then all tiles are small.
  std::uint64_t bytes_for_rays() const {
    const auto small = std::uint64_t(kernels::light_region) * kernels::light_region * tile_bytes_per_pixel;
    const std::uint64_t bytes = std::min(memory_of(options) / 16, std::uint64_t(threads_of(options)) * 2 * small);
    return options.cuda_device || bytes < 2 * small ? 0 : bytes;
  }

  /// Returns the tiles of an image that is not shown before it is complete. Large tiles need fewer passes.
  std::vector<kernels::CastTile> tiles_of_whole(int width, int height) const {
    const std::uint64_t bytes = bytes_for_rays();
    if (bytes == 0) return tiles_of(width, height, stream->tile_edge());
    return large_tiles_of(width, height, kernels::light_region, bytes / tile_bytes_per_pixel);
  }

  void fill(const Filling& filling_key) {
    if (stream && filling_key == filling) return;
    filling = filling_key;
    stream.reset();  // free its memory before the next stream allocates
    SceneStream::Options wishes{filling_key.lit_by ? daylight(*filling_key.lit_by) : kernels::unlit(),
                                filling_key.surface,
                                bytes_next_to_shards(),
                                policy.threads(),
                                options.cuda_device,
                                options.device_bytes,
                                filling_key.cells_alone,
                                {}};
    try {
      stream = std::make_unique<SceneStream>(*scene, source, wishes, policy, table || paged_table ? &numbers : nullptr);
    } catch (const CudaFailure& failure) {
      if (options.device_required) throw;
      problems.push_back(std::string("the CPU casts rays: ") + failure.what());
      wishes.cuda_device = options.cuda_device = {};
      wishes.memory_bytes = bytes_next_to_shards();
      stream = std::make_unique<SceneStream>(*scene, source, wishes, policy, table || paged_table ? &numbers : nullptr);
    }
    requested.clear();
    last = {};
  }

  /// Returns true if this view fills the pools or its pages evict each other. Pages are read repeatedly only if there
  /// is too little memory for them.
  bool is_starved(const SceneStream::Served& served) const {
    const std::uint64_t read = stream->page_counts().bytes_read - bytes_read_before;
    return served.is_full || read / max_page_reread_factor > stream->page_bytes_allowed();
  }

  void adopt_next() {
    scene = next->scene;
    numbers = std::move(next->numbers);
    edits = std::move(next->edits);
    if (paged_table) paged_table->show(scene);
    next.reset();
    heights.reset();
    requested.clear();
    last = {};
  }

  void look_at(const View& view) {
    if (same_picture(view, last)) return;
    last = view;
    starved = false;
    bytes_read_before = stream->page_counts().bytes_read;
  }

  kernels::CastCamera camera_of(const View& view) {
    if (view.mode == ViewMode::slope && !scene->header().has_normals)
      throw UsageError(
          "mode", "slope needs normals, and this scene was baked without; bake it with channels that hold normals");
    if (view.mode == ViewMode::voxel_class && !scene->header().has_classes)
      throw UsageError("mode", "class needs classes, and this scene has none; state them in its scene .json");
    kernels::CastCamera camera = make_camera(view.camera, *scene);
    if (shows_light(view.mode)) camera.tone = screen_tone(options.exposure_stops);
    if (!light_part_of(view)) camera.haze = haze_of(view);
    camera.debug_color = debug_color_of(view.mode);
    if (view.polygons) camera.polygons = polygons.drawn(view, camera, scene->header(), haze_of(view), policy);
    return camera;
  }

  kernels::CastHaze haze_of(const View& view) const {
    if (!view.background.sky || view.mode != ViewMode::lit) return {};
    return air(options.haze_visibility_m, scene->header().voxel_size_m, view.sun);
  }

  RenderSettings look_of(const View& view) {
    RenderSettings look{to_cast(view.background, shows_light(view.mode) ? view.sun : SunDirection{})};
    if (const auto part = light_part_of(view)) look.lighting = lighting(view.sun, *part, haze_of(view));
    if (view.mode == ViewMode::height && !heights) heights = occupied_heights(*scene);
    look.shader = shader_of(view, heights.value_or(HeightRange{}));
    look.blends_levels = view.level_blend == LevelBlend::on;
    return look;
  }

  void tell(FrameStats& stats) const {
    stats.pages_loading = stream->page_counts().queued;
    stats.files_opened = *files_opened;
    stats.bytes_held = stream->bytes_held();
    stats.bytes_allowed = stream->bytes_allowed();
    stats.starved = starved;
  }

  void put_in_wanted(const kernels::CastCamera& camera, const PreviewLimits& limits) {
    const auto start = Clock::now();
    const kernels::StopAsked enough = [over = after(limits.upload_s - upload_s), &limits] {
      return over() || is_asked(limits.stop);
    };
    stream->begin_pass();
    const SceneStream::Served served = stream->serve(requested, camera.eye, enough, {frame_pass, true});
    starved = starved || is_starved(served);
    put_in = served.uploads > 0;
    upload_s += since(start);
  }

  /// Uploads requested data until every tree has a resident root, for at most limits.roots_s.
  void wait_for_roots(const kernels::CastCamera& camera, const PreviewLimits& limits) {
    const auto start = Clock::now();
    stream->request_roots();
    const kernels::StopAsked over = after(limits.roots_s);
    while (stream->has_pending_roots() && !over() && !is_asked(limits.stop)) {
      put_in_wanted(camera, limits);
      if (!put_in) stream->wait(std::chrono::milliseconds(5));
    }
    waited_s = since(start);
    upload_s = 0;
  }

  /// Casts the view's rays. Rays that miss data wait for its upload within the time limit, then continue at the same
  /// sample. One frame can thus load several levels at about the cost of one cast. Afterwards coarser bricks replace
  /// the data that is still missing. They do so from the start, in one pass, if no time for uploads is left, or if
  /// the last frame left more requests than that time is enough for.
  void cast(const View& view, const kernels::CastCamera& camera, const PreviewLimits& limits, Picture& picture) {
    kernels::Caster& caster = stream->caster();
    const std::size_t rays = std::size_t(camera.width) * std::size_t(camera.height);
    std::future<Picture> blank = std::async(std::launch::async, blank_picture, camera.width, camera.height, view.light);
    caster.start(camera, {0, 0, camera.width, camera.height});
    const auto may_upload = [&] { return !starved && upload_s < limits.upload_s && !is_asked(limits.stop); };
    const bool waits = may_upload() && requested.size() <= max_awaited_requests;
    std::size_t waiting = caster.cast(0, rays, waits, limits.stop);
    frame_pass = caster.pass();
    while (waiting > 0 && may_upload()) {
      requested = caster.requested();
      put_in_wanted(camera, limits);
      if (!put_in) break;
      waiting = caster.cast(0, rays, true, limits.stop);
    }
    if (waits && waiting > 0) caster.cast(0, rays, false, limits.stop);
    requested = waits && waiting == 0 ? std::vector<std::uint32_t>() : caster.requested();
    was_complete = waiting == 0 && requested.empty();
    const RenderSettings look = look_of(view);
    if (look.blends_levels) {
      caster.start_blend();
      cast_more(camera, limits, [&](bool blocking) { return caster.cast_blend(0, rays, blocking, limits.stop); });
    }
    if (look.lighting) {
      caster.start_light(*look.lighting, look.shader);
      const auto cast_light = [&](bool blocking) { return caster.cast_light(0, rays, blocking, limits.stop); };
      cast_more(camera, limits, cast_light);
      caster.reuse_shadow_samples();
      cast_more(camera, limits, cast_light);
    }
    picture = blank.get();
    caster.resolve(look.background, pixels_of(picture));
  }

  /// Casts secondary rays in the same way as cast(). If primary rays missed data, secondary rays do not wait for data.
  void cast_more(const kernels::CastCamera& camera, const PreviewLimits& limits,
                 const std::function<std::size_t(bool blocking)>& pass) {
    const std::vector<std::uint32_t> wanted_before = requested;
    std::size_t waiting = was_complete ? pass(true) : SIZE_MAX;
    while (was_complete && waiting > 0 && !starved && upload_s < limits.upload_s && !is_asked(limits.stop)) {
      requested = stream->caster().requested();
      put_in_wanted(camera, limits);
      if (!put_in) break;
      waiting = pass(true);
    }
    if (waiting == 0) return;
    pass(false);
    was_complete = false;
    requested = stream->caster().requested();
    requested.insert(requested.end(), wanted_before.begin(), wanted_before.end());
    std::sort(requested.begin(), requested.end());
    requested.erase(std::unique(requested.begin(), requested.end()), requested.end());
  }

  /// Renders one pass over resident and newly uploaded data.
  Frame pass_over(const View& view, const PreviewLimits& limits, bool roots_first) {
    const auto start = Clock::now();
    const kernels::CastCamera camera = camera_of(view);
    const std::uint64_t uploads_before = stream->uploads();
    const std::uint32_t passes_before = stream->caster().pass();
    Frame frame;
    upload_s = waited_s = 0;
    if (roots_first) wait_for_roots(camera, limits);
    put_in_wanted(camera, limits);
    if (!stream->casts_on_host()) stream->prepare(requested, camera.eye);
    cast(view, camera, limits, frame.picture);
    frame.stats.upload_s = waited_s + upload_s;
    frame.stats.total_s = since(start);
    frame.stats.cast_s = frame.stats.total_s - frame.stats.upload_s;
    frame.stats.requested = requested.size();
    frame.stats.uploads = stream->uploads() - uploads_before;
    frame.stats.passes = stream->caster().pass() - passes_before;
    frame.stats.complete = was_complete;
    tell(frame.stats);
    return frame;
  }

  void show(const View& view) {
    fill(filling_of(view));
    look_at(view);
  }
};

}  // namespace gigabake
