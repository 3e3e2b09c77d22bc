#include "worker/pipeline/cell_stages.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/base/error.h"
#include "core/base/trace.h"
#include "format/shard/levels/brick_walk.h"
#include "format/shard/levels/content_hash.h"
#include "format/shard/shard_reader.h"
#include "format/shard/temporary_shard.h"
#include "format/source/levels/named_voxel_sizes.h"
#include "format/system/meters/stage_clock.h"
#include "kernels/cpu/bake_cell.h"
#include "worker/device/device_start.h"
#include "worker/pipeline/cell_parameters.h"
#include "worker/pipeline/clipped_cell.h"
#include "worker/pipeline/lattice.h"
#include "worker/pipeline/memory_shares.h"
#include "worker/pipeline/shard_from_volume.h"
#include "worker/pipeline/writer_pool_size.h"

namespace gigabake {
namespace {

const WorkerOptions& with_shard_folder(const WorkerOptions& options) {
  std::error_code error;
  std::filesystem::create_directories(options.out / "shards", error);
  if (error) throw InputError(options.out / "shards", "", "cannot make the folder: " + error.message());
  return options;
}

template <class AnyShard>
SceneCell scene_cell(const CellJob& job, const AnyShard& shard, const StoredShard& stored) {
  SceneCell cell = cell_of(job);
  cell.lods = shard.header.lods;
  cell.bytes = stored.file;
  cell.triangles = shard.header.triangles;
  cell.voxels = count_voxels(shard);
  cell.content_hash = shard.header.content_hash;
  cell.level_bytes = stored.levels;
  cell.node_bytes = stored.nodes;
  return cell;
}

std::vector<LevelSummary> with_stored(std::vector<LevelSummary> levels, const std::vector<std::uint64_t>& stored) {
  for (std::size_t lod = 0; lod < levels.size(); ++lod) levels[lod].stored_bytes = stored[lod];
  return levels;
}

std::vector<LevelSummary> summaries(const Shard& shard, const ThreadPool& pool) {
  return summarize_levels(shard, pool);
}

std::vector<LevelSummary> summaries(const PackedShard& shard, const ThreadPool&) { return summarize_levels(shard); }

/// Returns the sizes of a shard that an earlier run wrote.
StoredShard stored_shard(const std::filesystem::path& path, std::size_t lods) {
  const ShardReader reader(path);
  StoredShard stored{std::filesystem::file_size(path), {}, reader.node_bytes()};
  for (std::size_t lod = 0; lod < lods; ++lod) stored.levels.push_back(reader.level_bytes(int(lod)));
  return stored;
}

/// Returns the shard of an earlier run if it is complete, matches the job, and its voxels match the stored hash.
/// Cost    Each thread hashes a voxel in 16 ns, which is little compared with reading the voxel.
std::optional<Shard> published_shard(const std::filesystem::path& path, const CellJob& job, const BakeParameters& p,
                                     const std::optional<Geodetic>& origin, int threads) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return std::nullopt;
  try {
    Shard shard = read_shard(path);
    if (is_of_job(shard.header, job, p, origin) && !shard.above.empty() &&
        content_hash(shard, threads) == shard.header.content_hash)
      return shard;
  } catch (const InputError&) {
    // A damaged shard is baked again and replaced.
  }
  return std::nullopt;
}

void decide(InFlightCell& cell, CellOutcome outcome) {
  cell.report.outcome = outcome;
  cell.is_final = true;
}

}  // namespace

InFlightCell::InFlightCell(CellJob cell_job) : job(std::move(cell_job)) { report.id = job.id; }

CellStages::CellStages(SceneSources sources, BakeParameters parameters, const WorkerOptions& options)
    : sources_(std::move(sources)),
      parameters_(parameters),
      options_(with_shard_folder(options)),
      loader_(sources_, parameters_, cache_bytes(options_), options_.threads,
              scratch_in(options_.scratch, options_.memory_bytes)),
      overview_inputs_(overview_bytes(options_)),
      pool_(options_.threads),
      write_pool_(writer_pool_size_for(options_).threads) {
  if (sources_.area) area_.emplace(sources_.area, sources_.origin);
  if (!sources_.edits) return;
  edits_.emplace(sources_.edits, sources_.origin, snap_frame(parameters_));
  fingerprints_.emplace(parameters_, sources_);
}

bool CellStages::is_wholly_inside(const CellJob& job) const {
  return !area_ || area_->overlap(snap_frame(parameters_), Box3i64::cube(job.lattice_min, job.cell_voxels)) ==
                       AreaOverlap::inside;
}

void CellStages::claim_filled_voxels(const CellEdits& edits, const CellJob& job, MemoryClaim& memory) {
  constexpr std::uint64_t voxel_bytes = 2 * (4 + 2 + directional_coverage_bytes);
  const std::uint64_t bricks = job.cell_voxels / brick_edge;
  memory.add_items(edits.functions().filled_voxels(0, bricks * bricks * bricks), voxel_bytes, "edits", "filled voxels");
}

/// Returns whether the cell may have leaves: a source is voxelized at another level than 0, or branches end early.
bool CellStages::has_levels(const CellJob& job) const {
  return parameters_.depth_error != 0 || std::ranges::any_of(job.tiles, [this](std::uint32_t tile) {
           return may_have_levels(sources_.tiles.at(tile));
         });
}

/// Finds the edits that select a voxel of the cell, and claims the memory of the voxels that they fill.
void CellStages::find_edits(InFlightCell& cell) const {
  if (!edits_) return;
  auto edits = std::make_unique<const CellEdits>(*edits_, cell_parameters(cell.job, parameters_, 0), pool_);
  if (edits->empty()) return;
  cell.edits = std::move(edits);
  cell.edit_functions = cell.edits->functions();
  claim_filled_voxels(*cell.edits, cell.job, cell.loaded->memory);
}

kernels::CellParameters CellStages::parameters_of(const InFlightCell& cell, std::uint64_t memory_bytes) const {
  const CellJob& job = cell.job;
  kernels::CellParameters p = cell_parameters(job, parameters_, memory_bytes);
  if (cell.edits) p.edits = &cell.edit_functions;
  if (!is_wholly_inside(job))
    p.kept = [this](const Vec3i64& min, int lod) { return area_->inside(snap_frame(parameters_), min, lod); };
  return p;
}

/// Runs one step of a cell on the device. Returns false if there is no device, or if this or an earlier step of the
/// cell failed, if the border of the area cuts the cell, if it may have leaves, or if voxels have classes; the CPU then
/// bakes the cell.
template <class Step>
bool CellStages::on_device(InFlightCell& cell, const Step& step) {
  if (!options_.cuda_device || !cell.report.note.empty() || !is_wholly_inside(cell.job) || has_levels(cell.job) ||
      parameters_.classes)
    return false;
  try {
    step();
    return true;
  } catch (const CudaFailure& e) {
    cell.report.on_device = false;
    cell.report.note = std::string("baked on the CPU, because the GPU failed: ") + e.what();
    cell.device_input.reset();
    return false;
  }
}

void CellStages::prepare() {
  try {
    if (options_.cuda_device) make_baker();
  } catch (const std::exception&) {
    return;
  }
}

void CellStages::make_baker() {
  const std::scoped_lock lock(making_device_);  // std::call_once hangs under ThreadSanitizer if its function throws
  if (cuda_) return;
  const TraceSpan span("make baker");
  start_device(*options_.cuda_device);
  while (packers_.size() < readback_workers)
    packers_.push_back(std::make_unique<kernels::CudaPacker>(*options_.cuda_device));
  cuda_ = std::make_unique<kernels::CudaBaker>(*options_.cuda_device, texture_bytes(options_));
}

void CellStages::read(InFlightCell& cell) {
  const std::filesystem::path path = options_.out / shard_path(cell.job);
  const FileStamp before = stamp_of(path).value_or(FileStamp{});
  if (auto shard = published_shard(path, cell.job, parameters_, sources_.origin, options_.threads)) {
    cell.report.shard = before;
    const StoredShard stored = stored_shard(path, shard->levels.size());
    cell.report.cell = scene_cell(cell.job, *shard, stored);
    cell.report.levels = with_stored(summarize_levels(*shard), stored.levels);
    keep_for_overviews(cell.job, *std::move(shard));
    return decide(cell, CellOutcome::baked);
  }
  if (is_overview(cell.job)) {
    cell.children = read_children(
        options_.out, cell.job, [this](const std::string& file) { return overview_inputs_.find(file); }, pool_);
    return;
  }
  if (edit_stored(cell)) return;
  if (options_.stored_only) {
    cell.is_unstored = true;
    return;
  }
  cell.loaded = loader_.load(cell.job);
  find_edits(cell);
  on_device(cell, [&] {
    make_baker();
    const std::scoped_lock one_at_a_time(uploading_);
    cell.device_input = cuda_->upload(cell.loaded->input());
  });
}

void CellStages::bake_overview(InFlightCell& overview) const {
  overview.volume = make_overview(overview.job, overview.children, parameters_, pool_);
  overview.children.clear();
}

void CellStages::compute(InFlightCell& cell) {
  if (is_overview(cell.job)) return bake_overview(cell);
  const bool baked = on_device(cell, [&] {
    cell.device_volume = bake_on_device(cell);
    cell.volume_count = volumes_.add();
    cell.device_input.reset();
    cell.report.on_device = true;
  });
  if (!baked) bake_on_cpu(cell);
}

/// Bakes the cell in parts only if it does not fit into the memory by itself.
std::unique_ptr<kernels::CudaVolume> CellStages::bake_on_device(const InFlightCell& cell) {
  const kernels::CellParameters parameters = parameters_of(cell, device_kernel_bytes(options_));
  if (!volumes_.is_zero()) {
    if (auto volume = cuda_->bake_at_once(*cell.device_input, parameters)) return volume;
    volumes_.wait_until([] { return false; });
  }
  return cuda_->bake(*cell.device_input, parameters);
}

void CellStages::wait_for_device_memory() {
  const std::uint64_t memory = device_kernel_bytes(options_);
  if (memory == 0 || volumes_.is_zero()) return;
  const TraceSpan span("wait for device memory");
  volumes_.wait_until([&] { return cuda_->volume_bytes() + cuda_->expected_bytes() <= memory; });
}

void CellStages::read_back(InFlightCell& cell, std::size_t readback_worker) {
  if (cell.device_volume) read_back_from_device(cell, *packers_.at(readback_worker));
  cell.volume_count.reset();
  cell.loaded.reset();
  take_stats(cell);
  if (!cell.packed && cell.volume.levels.empty()) decide(cell, CellOutcome::empty);
}

void CellStages::read_back_from_device(InFlightCell& cell, kernels::CudaPacker& packer) {
  std::string why;  // reported only after read_back_volume(): a non-empty note disables the device for this cell
  try {
    pack_on_device(cell, packer);
  } catch (const DeviceFull& e) {
    why = std::string("packed on the CPU, because the GPU has not enough memory: ") + e.what();
  } catch (const CudaFailure& e) {
    why = std::string("packed on the CPU, because the GPU failed: ") + e.what();
  }
  if (cell.packed) return cell.device_volume.reset();
  read_back_volume(cell);
  if (cell.report.note.empty()) cell.report.note = why;
}

void CellStages::pack_on_device(InFlightCell& cell, kernels::CudaPacker& packer) {
  const ShardHeader header = header_of(cell);
  kernels::PackRequest request;
  for (std::uint32_t edge = header.cell_voxels; edge >= brick_edge; edge /= 2)
    request.levels.push_back(level_columns(header, int(request.levels.size())));
  request.nodes = packed_nodes(header);
  request.as = parameters_.codec == Codec::deflate ? kernels::ColumnBytes::stored : kernels::ColumnBytes::raw;
  pack_beside_others(cell, packer, request);
}

/// Packs with one readback worker's fraction of the memory. If it is small or does not suffice, waits for the other
/// readback workers and packs with all of the memory.
void CellStages::pack_beside_others(InFlightCell& cell, kernels::CudaPacker& packer, kernels::PackRequest& request) {
  constexpr std::uint64_t min_bytes = std::uint64_t(128) << 20;  // for large batches of chunks
  const std::uint64_t memory = packing_bytes(options_), fraction = memory / readback_workers;
  if (memory == 0 || fraction >= min_bytes) {
    try {
      const std::shared_lock lock(packing_);
      request.memory_bytes = fraction;
      cell.packed = packer.pack(*cell.device_volume, request);
      return;
    } catch (const DeviceFull&) {
    }
  }
  const std::scoped_lock lock(packing_);
  request.memory_bytes = memory;
  cell.packed = packer.pack(*cell.device_volume, request);
}

void CellStages::read_back_volume(InFlightCell& cell) {
  const std::scoped_lock lock(download_);
  if (!on_device(cell, [&] { cell.volume = cuda_->download(std::move(cell.device_volume)); })) bake_on_cpu(cell);
}

void CellStages::bake_on_cpu(InFlightCell& cell) const {
  cell.volume = kernels::bake_cell(cell.loaded->input(), parameters_of(cell, kernel_bytes(options_)), pool_);
}

void CellStages::clip(InFlightCell& cell, const ShardReader& shard) const {
  cell.volume = clipped_volume(shard, cell_parameters(cell.job, parameters_, kernel_bytes(options_)), *area_, pool_);
  if (cell.volume.levels.empty()) decide(cell, CellOutcome::empty);
}

void CellStages::take_stats(InFlightCell& cell) const {
  const kernels::CellStats& stats = cell.stats();
  cell.report.peak_bytes = stats.peak_bytes;
  cell.report.bad_uv = stats.bad_uv;
  if (stats.oversized != 0)
    throw InputError(cell.job.name, "",
                     std::to_string(stats.oversized) +
                         " triangles extend more than 4194304 voxels beyond the cell; enlarge `voxel_size_m`");
}

void CellStages::write(InFlightCell& cell) {
  const ShardHeader header = header_of(cell);
  const std::filesystem::path path = options_.out / shard_path(cell.job);
  cell.publication = std::make_unique<Publication>(path);
  const std::filesystem::path& temporary = cell.publication->temporary();
  const ShardWriteOptions how{write_pool_, parameters_.codec, file_image_bytes_for(options_)};
  if (cell.packed) {
    const PackedShard shard = shard_from_packed(*cell.packed, header);
    report_shard(cell, shard, write_temporary_shard(temporary, path, shard, how));
    keep_for_overviews(cell.job, shard);
    cell.packed.reset();
  } else {
    Shard shard = shard_from_volume(std::exchange(cell.volume, {}), header);
    report_shard(cell, shard, write_temporary_shard(temporary, path, shard, how));
    keep_for_overviews(cell.job, std::move(shard));
  }
}

void CellStages::publish(InFlightCell& cell) {
  cell.publication->publish();
  cell.report.shard = stamp_of(options_.out / shard_path(cell.job)).value_or(FileStamp{});
  cell.publication.reset();
  decide(cell, CellOutcome::baked);
}

template <class AnyShard>
void CellStages::report_shard(InFlightCell& cell, const AnyShard& shard, const StoredShard& stored) const {
  const InStage packing(BakeStage::packing);
  cell.report.cell = scene_cell(cell.job, shard, stored);
  cell.report.levels = with_stored(summaries(shard, write_pool_), stored.levels);
}

template <class AnyShard>
void CellStages::keep_for_overviews(const CellJob& job, AnyShard&& shard) {
  if (job.kept_lod == 0) return;
  overview_inputs_.keep(shard_path(job).generic_string(), child_of(std::forward<AnyShard>(shard), job.kept_lod));
}

ShardHeader CellStages::header_of(const InFlightCell& cell) const {
  ShardHeader h;
  h.generator = generator();
  h.cell = cell.job.name;
  h.lattice_min = cell.job.lattice_min;
  h.cell_voxels = cell.job.cell_voxels;
  h.first_lod = cell.job.first_lod;
  h.copied_lods = cell.job.copied_lods;
  h.voxel_size_m = parameters_.voxel_size_m;
  h.lattice_origin_m = parameters_.lattice_origin_m;
  h.origin = sources_.origin;
  h.fingerprint = cell.job.fingerprint;
  h.has_normals = parameters_.normals;
  h.has_directional_coverage = has_directional_coverage(parameters_);
  h.has_classes = parameters_.classes;
  h.triangles = cell.stats().triangles;
  return h;
}

}  // namespace gigabake
