#include "cluster/clip/clip_scene.h"

#include <algorithm>
#include <mutex>
#include <system_error>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/thread_pool.h"
#include "core/io/bytes.h"
#include "format/area/area_in_scene.h"
#include "format/job/cell_job.h"
#include "format/scene/paged_scene.h"
#include "format/scene/shard_of_scene.h"
#include "format/source/source.h"
#include "format/system/hash_bytes.h"
#include "scheduler/plan/merge.h"
#include "scheduler/plan/overviews.h"
#include "scheduler/plan/plan.h"
#include "worker/pipeline/cell_stages.h"
#include "worker/pipeline/lattice.h"

namespace gigabake {
namespace {

/// Returns the fingerprint of a cell that the border cuts.
Hash128 clipped_fingerprint(const Hash128& whole, const Hash128& border) {
  ByteWriter w;
  w.put(whole), w.put(border);
  return hash_of_bytes(w.take());
}

class SceneClipper {
 public:
  SceneClipper(const std::filesystem::path& scene_xml, const std::shared_ptr<const Area>& area,
               const std::filesystem::path& folder, int threads, const Progress& progress)
      : scene_(scene_xml),
        parameters_(parameters_from_json(scene_.header().parameters)),
        area_(area, scene_.header().origin),
        folder_(folder),
        progress_(progress),
        pool_(threads),
        stages_(sources_of(scene_.header(), area), parameters_, options_of(folder, threads)) {}

  std::filesystem::path run() {
    find_cells();
    plan_jobs();
    progress_.step("clipping cells", plan_.jobs.size(), "cell");
    for (std::size_t i = 0; i < cells_.size(); ++i) take(cell_report(i));
    expect_voxels();
    OverviewJobs overviews(plan_.jobs);
    for (const CellReport& report : reports_) overviews.is_done(report);
    for (std::size_t i = cells_.size(); i < plan_.jobs.size(); ++i) {
      take(overview_report(overviews.order(std::uint32_t(i))));
      overviews.is_done(reports_.back());
    }
    const std::filesystem::path out = folder_ / "scene.xml";
    write_scene(out, merge(plan_, reports_, scene_.header().origin, parameters_));
    return out;
  }

 private:
  static SceneSources sources_of(const SceneHeader& header, const std::shared_ptr<const Area>& area) {
    SceneSources sources;
    sources.origin = header.origin;
    sources.area = area;
    return sources;
  }

  static WorkerOptions options_of(const std::filesystem::path& folder, int threads) {
    WorkerOptions options;
    options.threads = threads;
    options.out = folder;
    return options;
  }

  AreaOverlap overlap(const SceneCell& cell) const { return area_.overlap(snap_frame(parameters_), window_of(cell)); }

  void find_cells() {
    progress_.step("finding cells in the area");
    std::mutex mutex;
    scene_.for_each_page(pool_, [&](std::size_t, std::span<const SceneCell> cells) {
      for (const SceneCell& cell : cells) {
        if (overlap(cell) == AreaOverlap::outside) continue;
        const std::scoped_lock lock(mutex);
        cells_.push_back(cell);
      }
    });
    std::sort(cells_.begin(), cells_.end(), is_before);
    if (cells_.empty()) throw UsageError("no cell of the scene intersects the area of interest");
  }

  void store(InFlightCell& cell) {
    if (cell.is_final) return;
    stages_.write(cell);
    stages_.publish(cell);
  }

  /// Throws UsageError if all cells are on the border and none has a voxel inside.
  void expect_voxels() const {
    for (const CellReport& report : reports_)
      if (report.outcome == CellOutcome::baked) return;
    throw UsageError("no voxel of the scene is inside the area of interest");
  }

  void plan_jobs() {
    for (const SceneCell& cell : cells_) {
      CellJob job = job_of(cell);
      job.id = std::uint32_t(plan_.jobs.size());
      if (overlap(cell) != AreaOverlap::inside)
        job.fingerprint =
            clipped_fingerprint(cell.fingerprint, area_.border_hash(snap_frame(parameters_), window_of(cell)));
      plan_.jobs.push_back(std::move(job));
      plan_.bounds = hull(plan_.bounds, window_of(cell));
    }
    const SceneHeader& header = scene_.header();
    if (!header.bounds.is_empty()) plan_.bounds = intersection(plan_.bounds, header.bounds);
    plan_.triangles = header.triangles;
    plan_.losses = header.losses;
    if (scene_.totals().overviews != 0) add_overviews(plan_.jobs);
  }

  CellReport cell_report(std::size_t index) {
    const SceneCell& cell = cells_[index];
    const std::filesystem::path shard = scene_.folder() / cell.file;
    if (overlap(cell) != AreaOverlap::inside) {
      InFlightCell clipped(plan_.jobs[index]);
      stages_.clip(clipped, open_shard_of_scene(scene_.file(), scene_.header(), cell));
      store(clipped);
      return std::move(clipped.report);
    }
    std::error_code error;
    std::filesystem::create_symlink(std::filesystem::absolute(shard), folder_ / cell.file, error);
    if (error) throw InputError(folder_ / cell.file, "", "cannot be linked: " + error.message());
    CellReport report;
    report.id = std::uint32_t(index);
    report.outcome = CellOutcome::baked;
    report.cell = cell;
    return report;
  }

  CellReport overview_report(CellJob job) {
    InFlightCell overview(std::move(job));
    stages_.read(overview);
    stages_.compute(overview);
    stages_.read_back(overview, 0);
    store(overview);
    return std::move(overview.report);
  }

  void take(CellReport report) {
    reports_.push_back(std::move(report));
    progress_.advance();
  }

  PagedScene scene_;
  BakeParameters parameters_;
  AreaInScene area_;
  std::filesystem::path folder_;
  const Progress& progress_;
  ThreadPool pool_;
  CellStages stages_;
  std::vector<SceneCell> cells_;
  BakePlan plan_;
  std::vector<CellReport> reports_;
};

}  // namespace

std::filesystem::path clip_scene(const std::filesystem::path& scene_xml, const std::shared_ptr<const Area>& area,
                                 const std::filesystem::path& folder, int threads, const Progress& progress) {
  return SceneClipper(scene_xml, area, folder, threads, progress).run();
}

}  // namespace gigabake
