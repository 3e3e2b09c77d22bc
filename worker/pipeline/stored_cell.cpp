#include <algorithm>

#include "core/base/error.h"
#include "core/base/work_counts.h"
#include "format/shard/splice/spliced_shard.h"
#include "worker/edit/shard_edit.h"
#include "worker/pipeline/cell_parameters.h"
#include "worker/pipeline/cell_stages.h"
#include "worker/pipeline/shard_from_volume.h"
#include "worker/pipeline/writer_pool_size.h"

namespace gigabake {
namespace {

std::vector<LevelSummary> with_stored(std::vector<LevelSummary> levels, const StoredShard& stored) {
  for (std::size_t lod = 0; lod < levels.size(); ++lod) levels[lod].stored_bytes = stored.levels[lod];
  return levels;
}

SceneCell scene_cell(const CellJob& job, const EditedShard& edited, const StoredShard& stored) {
  SceneCell cell = cell_of(job);
  cell.lods = edited.shard.header.lods;
  cell.bytes = stored.file;
  cell.triangles = edited.shard.header.triangles;
  cell.voxels = edited.voxels;
  cell.content_hash = edited.shard.header.content_hash;
  cell.level_bytes = stored.levels;
  cell.node_bytes = stored.nodes;
  return cell;
}

bool finish(InFlightCell& cell, CellOutcome outcome) {
  cell.report.outcome = outcome;
  return cell.is_final = true;
}

}  // namespace

/// Makes the cell from a stored shard of it with fewer edits. Returns false if OUT has none, or it cannot be used; the
/// cell must then be baked from its source.
bool CellStages::edit_stored(InFlightCell& cell) const {
  if (!fingerprints_ || parameters_.max_error != 0 || cell.job.tile_sources.size() != cell.job.tiles.size())
    return false;
  if (has_levels(cell.job)) return false;  // an edit refines leaves, which requires their triangles
  for (const CellFingerprints::EarlierEdits& earlier : fingerprints_->with_fewer_edits(cell.job)) {
    CellJob job = cell.job;
    job.fingerprint = earlier.fingerprint;
    std::error_code error;
    if (!std::filesystem::is_regular_file(options_.out / shard_path(job), error)) continue;
    try {
      return edit_stored(cell, job, earlier.edits);
    } catch (const InputError&) {
      return false;  // a damaged shard is of no use
    }
  }
  return false;
}

/// Applies all edits except the first `applied` to the shard of `earlier`.
bool CellStages::edit_stored(InFlightCell& cell, const CellJob& earlier, std::size_t applied) const {
  const BaseShard base(options_.out / shard_path(earlier), pool_);
  if (!is_of_job(base.header(), earlier, parameters_, sources_.origin) || !base.is_spliceable()) return false;
  const kernels::CellParameters parameters = parameters_of(cell, 0);
  const CellEdits edits(*edits_, parameters, pool_, applied);
  MemoryClaim memory("cell", cell_advice);
  claim_filled_voxels(edits, cell.job, memory);
  std::optional<EditedShard> edited = edited_shard(base, edits, parameters, pool_);
  if (!edited) return false;
  count_work(WorkCounter::edited_bricks, edited->bricks);
  if (edited->empty()) return finish(cell, CellOutcome::empty);
  ShardHeader header = header_of(cell);
  header.triangles = base.header().triangles;
  header.lods = base.header().lods;
  header.content_hash = std::move(edited->shard.header.content_hash);
  edited->shard.header = std::move(header);
  const std::filesystem::path path = options_.out / shard_path(cell.job);
  const StoredSplice stored =
      write_spliced_shard(path, edited->shard, base, {pool_, parameters_.codec, file_image_bytes_for(options_)});
  count_work(WorkCounter::shard_bytes_copied, stored.copied);
  cell.report.shard = stamp_of(path).value_or(FileStamp{});
  cell.report.cell = scene_cell(cell.job, *edited, stored.stored);
  cell.report.levels = with_stored(edited->summaries, stored.stored);
  return finish(cell, CellOutcome::baked);
}

}  // namespace gigabake
