/// The job of a cell, which rank 0 sends to a worker, and the worker's report. Jobs and reports are plain values, so
/// that a test can replay them. Their serialized bytes are sent over MPI; the journal stores serialized reports.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/base/rules.h"
#include "core/math/vec3.h"
#include "format/job/tile_scan.h"
#include "format/scene/xml/scene_xml.h"
#include "format/shard/levels/level_summary.h"
#include "format/shard/shard.h"
#include "format/system/file_stamp.h"

namespace gigabake {

/// A cell, or an overview: the levels above a block of cells or of other overviews (scheduler/plan/overviews.h).
struct CellJob {
  std::uint32_t id = 0;              ///< index into BakePlan::jobs
  std::string name;                  ///< "c_X_Y_Z": column and stack index; "pL_X_Y_Z" for an overview
  Vec3i64 lattice_min{};             ///< lod-0 voxels; multiples of N in x and y, of the coarsest level's voxel in z
  std::uint32_t cell_voxels = 0;     ///< N
  std::vector<std::uint32_t> tiles;  ///< indices into SceneSources::tiles, ascending
  std::uint64_t triangles = 0;       ///< estimate, used to order the jobs
  Hash128 fingerprint;
  std::vector<Hash128> tile_sources;  ///< TileScan::source of each of `tiles`; empty: not checked
  std::uint32_t first_lod = 0;        ///< overview: its finest level on the lattice. 0: a cell
  std::uint32_t copied_lods = 0;      ///< overview: number of levels from first_lod on that duplicate the children's
  std::uint32_t kept_lod = 0;         ///< finest lattice level that its overview duplicates; 0: it has no overview
  std::vector<std::uint32_t> children = {};   ///< overview: jobs that must complete first, ascending
  std::vector<std::string> child_files = {};  ///< dispatched overview: shards of its children that have voxels
};

inline bool is_overview(const CellJob& job) { return job.first_lod != 0; }

enum class CellOutcome : std::uint8_t {
  baked,
  empty,
  failed,   ///< a retry may succeed: out of memory, failed I/O
  refused,  ///< a retry would fail too: bad input, a limit
};
template <>
constexpr auto names_of<CellOutcome>() {
  return std::to_array<std::string_view>({"baked", "empty", "failed", "refused"});
}

struct CellReport {
  std::uint32_t id = 0;
  CellOutcome outcome = CellOutcome::failed;
  std::string error;                             ///< one line when failed or refused
  SceneCell cell;                                ///< the scene's entry, if baked
  double read_s = 0, kernel_s = 0, write_s = 0;  ///< wall time per stage
  std::uint64_t peak_bytes = 0;                  ///< peak of the kernels' working memory
  bool on_device = false;                        ///< the kernels ran on a GPU
  std::uint64_t bad_uv = 0;                      ///< triangles baked without their unusable texture coordinates
  std::string note;                              ///< one-line warning, although the job succeeded
  std::vector<LevelSummary> levels = {};         ///< per lod, if baked
  FileStamp shard = {};  ///< stamp of OUT/<cell.file>, taken after the write or before the reuse of the shard, if baked
};

/// Returns the job that made a cell or overview of the scene. The job has no tiles and no children, because scenes do
/// not record them.
CellJob job_of(const SceneCell& cell);
/// Returns the scene's entry for the job, with the fields that are known before baking. Levels and sizes are missing.
SceneCell cell_of(const CellJob& job);

/// Returns the path of the job's shard relative to OUT, the bake's folder: shards/<name>-<fingerprint>.h5.
std::filesystem::path shard_path(const CellJob& job);
std::string shard_file(const std::string& name, const Hash128& fingerprint);

std::vector<std::uint8_t> to_bytes(const CellJob& job);
std::vector<std::uint8_t> to_bytes(const CellReport& report);
std::vector<std::uint8_t> to_bytes(const TileScan& scan);
CellJob job_from_bytes(std::span<const std::uint8_t> bytes);        ///< Errors  InputError if malformed
CellReport report_from_bytes(std::span<const std::uint8_t> bytes);  ///< Errors  InputError if malformed
TileScan scan_from_bytes(std::span<const std::uint8_t> bytes);      ///< Errors  InputError if malformed

}  // namespace gigabake
