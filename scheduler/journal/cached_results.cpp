#include "scheduler/journal/cached_results.h"

#include <optional>

#include "core/base/thread_pool.h"

namespace gigabake {
namespace {

struct PriorCell {
  CacheStatus reason;
  std::optional<CellReport> done;
};

/// Returns the recorded report without its run-specific members.
CellReport taken_over(const CellJob& job, CellReport report) {
  report.id = job.id;
  report.read_s = report.kernel_s = report.write_s = 0;
  report.peak_bytes = 0;
  report.on_device = false;
  report.note.clear();
  return report;
}

/// Returns true if the reported cell agrees with the job and the shard in all members, not only in the fingerprint.
bool describes(const SceneCell& cell, const CellJob& job, const FileStamp& shard) {
  return cell.name == job.name && cell.file == shard_path(job).generic_string() &&
         cell.lattice_min == job.lattice_min && cell.cell_voxels == job.cell_voxels &&
         cell.first_lod == job.first_lod && cell.copied_lods == job.copied_lods &&
         cell.fingerprint == job.fingerprint && cell.bytes == shard.size;
}

PriorCell prior_cell(const CellJob& job, const JournalContent& journal, const std::filesystem::path& out) {
  std::optional<CellReport> known = journal.find(job.fingerprint);
  if (known && known->outcome == CellOutcome::empty)
    return {CacheStatus::unchanged, taken_over(job, std::move(*known))};
  const std::optional<FileStamp> shard = stamp_of(out / shard_path(job));
  if (shard != FileStamp{}) {
    const bool is_trusted = known && known->outcome == CellOutcome::baked && shard && known->shard == *shard &&
                            describes(known->cell, job, *shard);
    if (is_trusted) return {CacheStatus::unchanged, taken_over(job, std::move(*known))};
    return {CacheStatus::to_be_checked, {}};
  }
  if (known) return {CacheStatus::shard_missing, {}};
  return {journal.knows_cell(job.name) ? CacheStatus::inputs_changed : CacheStatus::new_cell, {}};
}

}  // namespace

std::array<std::size_t, cache_statuses> CachedResults::counts() const {
  std::array<std::size_t, cache_statuses> out{};
  for (const CacheStatus r : reasons) ++out.at(std::size_t(r));
  return out;
}

CachedResults find_cached(const BakePlan& plan, const JournalContent& journal, const std::filesystem::path& out,
                          int threads) {
  std::vector<std::optional<CellReport>> done(plan.jobs.size());
  CachedResults results;
  results.reasons.resize(plan.jobs.size());
  ThreadPool(threads).parallel_for(plan.jobs.size(), 256, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i) {
      PriorCell cell = prior_cell(plan.jobs[i], journal, out);
      results.reasons[i] = cell.reason;
      done[i] = std::move(cell.done);
    }
  });
  for (std::optional<CellReport>& report : done)
    if (report) results.done.push_back(std::move(*report));
  return results;
}

}  // namespace gigabake
