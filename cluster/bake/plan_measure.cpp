#include "cluster/bake/plan_measure.h"

#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <numeric>
#include <utility>
#include <variant>

#include "cluster/bake/plan_textures.h"
#include "cluster/bake/scan_tiles.h"
#include "cluster/launch/rank_setup.h"
#include "cluster/process/temporary_folder.h"
#include "core/base/error.h"
#include "scheduler/plan/piece_order.h"
#include "worker/tiles/tile_store.h"

namespace gigabake {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double asked_size_s = 1.5, other_size_s = 0.75;  ///< time budgets for baking at one voxel size
constexpr double max_overrun = 4;                          ///< pieces in flight are abandoned after this many budgets
constexpr double max_start_s = 30;
constexpr double min_split_bytes_per_s = 2e7;  ///< min bytes per second when a large tile is split
constexpr std::size_t max_tiles = 12, max_pieces_in_flight = 4, pieces_wanted = 10;
constexpr double voxels_per_thread_s = 4e5;  ///< a guess, which determines the size of pieces
constexpr std::uint64_t seed = 20261122;
constexpr std::chrono::milliseconds max_nap{5};

double elapsed_s(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Returns the cells of a piece's column. Their ids begin at first_id, and their shard names are unique.
std::vector<CellJob> jobs_of(const Piece& piece, const BakeParameters& parameters, std::uint32_t first_id) {
  const std::uint32_t cell_voxels = parameters.cell_voxels;
  const CellStack stack = stack_over(piece.column.z_min, piece.column.z_end, cell_voxels, parameters.coarsest_lod);
  std::vector<CellJob> jobs;
  for (std::int64_t level = 0; level < stack.cells; ++level) {
    CellJob job;
    job.id = first_id + std::uint32_t(level);
    job.name = "piece_" + std::to_string(job.id);
    job.lattice_min = {piece.column.column_x * cell_voxels, piece.column.column_y * cell_voxels,
                       stack.z_min + level * cell_voxels};
    job.cell_voxels = cell_voxels;
    job.tiles = {piece.tile};
    job.triangles = piece.column.triangles;
    jobs.push_back(std::move(job));
  }
  return jobs;
}

/// A measurement at one voxel size: it bakes sample pieces (scheduler/plan/piece_order.h), which are columns of single
/// tiles.
class SizeSampler {
 public:
  /// Starts the bake process. `large_bytes` is the size of the tiles that must be split before a piece of them can be
  /// baked.
  SizeSampler(const WorkerSetup& setup, BakeProcessOptions options, double budget_s, std::uint64_t large_bytes,
              const Progress& progress)
      : setup_(setup),
        budget_s_(budget_s),
        progress_(progress),
        process_(setup, limited(std::move(options), budget_s, large_bytes)) {
    process_.prepare();
  }

  /// Runs the measurement; sample() and the other results are valid afterwards. `order` contains the tiles in random
  /// order.
  void run(const std::vector<std::uint32_t>& order) {
    wait_for_device();
    const std::vector<TileScan> scans = scan_some(order);
    const std::vector<Piece> pieces = piece_order(scans, scans.size() == order.size(), seed);
    bake_some(pieces);
  }

  const BakedSample& sample() const { return sample_; }
  const std::vector<std::uint32_t>& tiles() const { return tiles_; }
  const std::string& problem() const { return problem_; }
  bool on_device() const { return on_device_; }

 private:
  struct InFlightPiece {
    BakedPiece piece;
    std::size_t cells_left = 0;
    bool is_whole = true;
  };

  static BakeProcessOptions limited(BakeProcessOptions options, double budget_s, std::uint64_t large_bytes) {
    options.timeouts.cell_timeout_s =
        std::max(10.0, max_overrun * budget_s) + double(large_bytes) / min_split_bytes_per_s;
    return options;
  }

  void nap() {
    progress_.advance(0);
    process_.wait(max_nap);
  }

  void wait_for_device() {
    const auto start = Clock::now();
    while (!process_.device() && problem_.empty()) {
      if (elapsed_s(start) > max_start_s) problem_ = "the bake process does not start";
      process_.prepare();
      nap();
      while (const auto event = process_.poll())
        if (const auto* died = std::get_if<BakeProcess::Died>(&*event)) problem_ = died->why;
    }
    if (process_.device() && !process_.device()->error.empty()) problem_ = process_.device()->error;
  }

  /// Scans the first readable tiles, within a third of the time budget.
  std::vector<TileScan> scan_some(const std::vector<std::uint32_t>& order) {
    std::vector<TileScan> scans;
    const auto start = Clock::now();
    for (const std::uint32_t tile : order) {
      if (!problem_.empty() || scans.size() == max_tiles) break;
      if (!scans.empty() && elapsed_s(start) > budget_s_ / 3) break;
      if (auto scan = scan_one(tile)) scans.push_back(std::move(*scan));
    }
    return scans;
  }

  std::optional<TileScan> scan_one(std::uint32_t tile) {
    process_.scan(tile);
    while (process_.in_flight() != 0) {
      nap();
      while (auto event = process_.poll()) {
        if (const auto* died = std::get_if<BakeProcess::Died>(&*event)) problem_ = died->why;
        auto* scanned = std::get_if<BakeProcess::Scanned>(&*event);
        if (scanned != nullptr && !scanned->scan.columns.empty()) return std::move(scanned->scan);
      }
    }
    return std::nullopt;
  }

  void bake_some(const std::vector<Piece>& pieces) {
    const auto start = Clock::now();
    std::size_t next = 0;
    while (problem_.empty()) {
      const double now_s = elapsed_s(start);
      while (next < pieces.size() && process_.in_flight() < max_pieces_in_flight && now_s < budget_s_)
        submit(pieces[next++]);
      if (process_.in_flight() == 0) return;
      if (now_s > max_overrun * budget_s_) {
        problem_ = fmt::format("a piece takes longer than {:.0f} s", max_overrun * budget_s_);
        return;
      }
      nap();
      while (const auto event = process_.poll()) take(*event, start);
    }
  }

  void submit(const Piece& piece) {
    const std::vector<CellJob> jobs = jobs_of(piece, setup_.parameters, std::uint32_t(owner_.size()));
    InFlightPiece in_flight;
    in_flight.piece.tile = piece.tile;
    in_flight.piece.projected_voxels = double(piece.column.projected_voxels) / projected_voxel_unit;
    in_flight.cells_left = jobs.size();
    for (const CellJob& job : jobs) {
      owner_.push_back(in_flight_.size());
      process_.submit(job, 0);
    }
    in_flight_.push_back(in_flight);
  }

  void take(const BakeProcess::Event& event, Clock::time_point start) {
    if (const auto* died = std::get_if<BakeProcess::Died>(&event)) problem_ = died->why;
    const auto* baked = std::get_if<BakeProcess::Baked>(&event);
    if (baked == nullptr) return;
    const CellReport& report = baked->report;
    InFlightPiece& owner = in_flight_[owner_.at(report.id)];
    owner.is_whole = owner.is_whole && report.outcome != CellOutcome::failed;
    add(report, owner.piece);
    if (--owner.cells_left != 0 || !owner.is_whole) return;
    sample_.pieces.push_back(owner.piece);
    sample_.wall_s = elapsed_s(start);
    if (std::find(tiles_.begin(), tiles_.end(), owner.piece.tile) == tiles_.end()) tiles_.push_back(owner.piece.tile);
  }

  void add(const CellReport& report, BakedPiece& piece) {
    piece.read_s += report.read_s;
    piece.kernel_s += report.kernel_s;
    piece.write_s += report.write_s;
    if (report.outcome != CellOutcome::baked) return;
    on_device_ = on_device_ || report.on_device;
    ++piece.cells;
    // Surface that is voxelized at a coarser level has most voxels there.
    piece.voxels_lod0 += *std::ranges::max_element(report.cell.voxels);
    piece.voxels = std::accumulate(report.cell.voxels.begin(), report.cell.voxels.end(), piece.voxels);
    piece.shard_bytes += report.cell.bytes;
    for (const LevelSummary& level : report.levels) piece.level_bytes += level.stored_bytes;
    std::error_code ignored;
    std::filesystem::remove(setup_.worker.out / report.cell.file, ignored);
  }

  const WorkerSetup setup_;
  const double budget_s_;
  const Progress progress_;
  BakeProcess process_;
  BakedSample sample_;
  std::vector<InFlightPiece> in_flight_;
  std::vector<std::size_t> owner_;  ///< index into in_flight_, by cell id
  std::vector<std::uint32_t> tiles_;
  std::string problem_;
  bool on_device_ = false;
};

/// Returns the ratio of projected voxels at this voxel size to those at the plan's voxel size.
double scale_of(double voxel_size_m, const BakeRequest& request) {
  const double ratio = request.parameters.voxel_size_m / voxel_size_m;
  return ratio * ratio;
}

SampledScene scene_at(double voxel_size_m, const MpiSession& mpi, const BakeRequest& request, const BakePlan& plan) {
  const double scale = scale_of(voxel_size_m, request);
  SampledScene scene;
  for (const std::uint64_t c : plan.tile_crossings) scene.projected_voxels += scale * double(c) / projected_voxel_unit;
  scene.tile_triangles = plan.tile_triangles;
  scene.cells = std::max<std::uint64_t>(1, std::uint64_t(scale * double(plan.jobs.size()) + 0.5));
  scene.ranks = mpi.ranks();
  return scene;
}

WorkerSetup setup_at(double voxel_size_m, double budget_s, const std::filesystem::path& folder, const MpiSession& mpi,
                     const BakeRequest& request, const SharedSources& sources) {
  WorkerSetup setup = setup_of(mpi, request, sources);
  setup.parameters.voxel_size_m = voxel_size_m;
  const std::uint32_t wanted_voxels = piece_voxels(
      voxels_per_thread_s * setup.worker.threads * budget_s / double(pieces_wanted), request.parameters.cell_voxels);
  setup.parameters.cell_voxels =
      std::max(wanted_voxels, std::uint32_t(brick_edge) << request.parameters.coarsest_lod);  // has the coarsest level
  setup.worker.out = folder;
  setup.worker.scratch = folder / "scratch";  // shared by all sizes, so that a large tile is split only once
  return setup;
}

MeasuredSize measured(double voxel_size_m, const SizeSampler& sampler, const SampledScene& scene) {
  MeasuredSize size;
  size.voxel_size_m = voxel_size_m;
  size.estimate = estimate_size(scene, sampler.sample());
  size.pieces = sampler.sample().pieces.size();
  size.tiles = sampler.tiles().size();
  for (const BakedPiece& piece : sampler.sample().pieces) size.voxels_found += piece.voxels_lod0;
  size.wall_s = sampler.sample().wall_s;
  size.on_device = sampler.on_device();
  size.problem = sampler.problem();
  return size;
}

TextureFindings textures_of(const SceneSources& sources, const std::vector<std::uint32_t>& tiles,
                            const WorkerSetup& setup) {
  const TileScratch scratch = scratch_in(setup.worker.scratch, setup.worker.memory_bytes);
  return examine_textures(sources, tiles, TileStore(sources, setup.parameters, scratch, setup.worker.threads),
                          scratch.max_tile_bytes);
}

/// Returns the bake's scratch folder. Names of folders that the request does not determine are replaced by
/// placeholders.
std::filesystem::path scratch_of_bake(const BakeRequest& request) {
  if (!request.out.empty()) return scratch_of(request);
  return request.scratch.empty() ? std::filesystem::path("SCENE") / "scratch" : request.scratch;
}

/// Estimates the sizes at which no piece was baked, by scaling the estimate of the requested size.
void fill_gaps(std::vector<MeasuredSize>& sizes, const MeasuredSize& asked, const BakeRequest& request) {
  for (MeasuredSize& size : sizes)
    if (size.pieces == 0 && asked.pieces != 0)
      size.estimate = scaled(asked.estimate, scale_of(size.voxel_size_m, request));
}

}  // namespace

PlanMeasure measure_plan(const MpiSession& mpi, const BakeRequest& requested, const SharedSources& sources,
                         const BakePlan& plan, bool measures, const Progress& progress) {
  BakeRequest request = requested;
  request.parameters = sources.parameters;
  PlanMeasure out;
  out.ranks = mpi.ranks();
  out.threads = threads_of(mpi, request);
  out.scratch = scratch_need(sources.scene, memory_of(mpi, request));
  out.scratch_folder = scratch_of_bake(request);
  const double asked_m = request.parameters.voxel_size_m;
  for (const double size_m : {asked_m / 2, asked_m, asked_m * 2})
    out.sizes.push_back({size_m, estimate_size(scene_at(size_m, mpi, request, plan), {}), 0, 0, 0, 0, false, ""});
  if (!measures) return out;
  const TemporaryFolder folder(request.scratch);
  try {
    scratch_info(out.scratch, folder.path());
  } catch (const InputError& no_room) {
    for (MeasuredSize& size : out.sizes) size.problem = no_room.what();
    return out;
  }
  const std::vector<std::uint32_t> order = weighted_order(plan.tile_crossings, seed);
  progress.step("baking pieces");
  for (const std::size_t at : {1, 0, 2}) {
    const double size_m = out.sizes[at].voxel_size_m, budget_s = at == 1 ? asked_size_s : other_size_s;
    const WorkerSetup setup = setup_at(size_m, budget_s, folder.path(), mpi, request, sources);
    SizeSampler sampler(setup, process_options(request), budget_s, out.scratch.bytes, progress);
    sampler.run(order);
    out.sizes[at] = measured(size_m, sampler, scene_at(size_m, mpi, request, plan));
    if (at == 1) out.textures = textures_of(sources.scene, sampler.tiles(), setup);
  }
  fill_gaps(out.sizes, out.requested(), request);
  return out;
}

}  // namespace gigabake
