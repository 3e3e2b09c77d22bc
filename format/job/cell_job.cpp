#include "format/job/cell_job.h"

#include "core/io/bytes.h"

namespace gigabake {
namespace {

/// Calls `f` for each field: ByteWriter::put to serialize, ByteReader::get to restore.
template <class Cell, class F>
void each_field_of_cell(Cell& c, const F& f) {
  f(c.name), f(c.file), f(c.lattice_min), f(c.cell_voxels), f(c.lods), f(c.bytes), f(c.triangles), f(c.voxels),
      f(c.fingerprint), f(c.content_hash), f(c.level_bytes), f(c.node_bytes), f(c.first_lod), f(c.copied_lods);
}

template <class Job, class F>
void each_field_of_job(Job& j, const F& f) {
  f(j.id), f(j.name), f(j.lattice_min), f(j.cell_voxels), f(j.tiles), f(j.triangles), f(j.fingerprint),
      f(j.tile_sources), f(j.first_lod), f(j.copied_lods), f(j.kept_lod), f(j.children), f(j.child_files);
}

template <class Report, class F>
void each_field_of_report(Report& r, const F& f) {
  f(r.id), f(r.outcome), f(r.error), each_field_of_cell(r.cell, f), f(r.read_s), f(r.kernel_s), f(r.write_s),
      f(r.peak_bytes), f(r.on_device), f(r.bad_uv), f(r.note), f(r.levels), f(r.shard);
}

template <class Scan, class F>
void each_field_of_scan(Scan& s, const F& f) {
  f(s.tile), f(s.columns), f(s.triangles), f(s.non_finite), f(s.zero_area), f(s.skipped_points), f(s.skipped_lines),
      f(s.source), f(s.error), f(s.spacing_m), f(s.too_far), f(s.reach_m), f(s.bounds.min), f(s.bounds.end),
      f(s.classified), f(s.sized), f(s.is_refused);
}

template <class File, class F>
void each_field_of_file(File& file, const F& f) {
  f(file.name), f(file.stamp), f(file.settled);
}

/// Copies the fields that a job and the scene's entry have in common.
template <class To, class From>
To same_cell(const From& from) {
  To to;
  to.name = from.name;
  to.lattice_min = from.lattice_min;
  to.cell_voxels = from.cell_voxels;
  to.triangles = from.triangles;
  to.fingerprint = from.fingerprint;
  to.first_lod = from.first_lod;
  to.copied_lods = from.copied_lods;
  return to;
}

}  // namespace

CellJob job_of(const SceneCell& cell) { return same_cell<CellJob>(cell); }

SceneCell cell_of(const CellJob& job) {
  SceneCell cell = same_cell<SceneCell>(job);
  cell.file = shard_path(job).generic_string();
  return cell;
}

std::filesystem::path shard_path(const CellJob& job) { return shard_file(job.name, job.fingerprint); }

std::string shard_file(const std::string& name, const Hash128& fingerprint) {
  return "shards/" + name + "-" + fingerprint.hex() + ".h5";
}

std::vector<std::uint8_t> to_bytes(const CellJob& job) {
  ByteWriter w;
  each_field_of_job(job, [&w](const auto& field) { w.put(field); });
  return w.take();
}

std::vector<std::uint8_t> to_bytes(const CellReport& report) {
  ByteWriter w;
  each_field_of_report(report, [&w](const auto& field) { w.put(field); });
  return w.take();
}

std::vector<std::uint8_t> to_bytes(const TileScan& scan) {
  ByteWriter w;
  const auto put = [&w](const auto& field) { w.put(field); };
  each_field_of_scan(scan, put);
  put(std::uint64_t(scan.files.size()));
  for (const StampedFile& file : scan.files) each_field_of_file(file, put);
  put(std::uint64_t(scan.warnings.size()));
  for (const SourceWarning& warning : scan.warnings) each_field_of_warning(warning, put);
  return w.take();
}

CellJob job_from_bytes(std::span<const std::uint8_t> bytes) {
  ByteReader r(bytes, "cell job");
  CellJob job;
  each_field_of_job(job, [&r](auto& field) { r.get(field); });
  r.expect_end();
  if (!job.tile_sources.empty() && job.tile_sources.size() != job.tiles.size())
    throw InputError("cell job", "tile_sources", "expected one for each tile, or none");
  return job;
}

CellReport report_from_bytes(std::span<const std::uint8_t> bytes) {
  ByteReader r(bytes, "cell report");
  CellReport report;
  each_field_of_report(report, [&r](auto& field) { r.get(field); });
  r.expect_end();
  return report;
}

TileScan scan_from_bytes(std::span<const std::uint8_t> bytes) {
  ByteReader r(bytes, "tile survey");
  TileScan scan;
  const auto get = [&r](auto& field) { r.get(field); };
  each_field_of_scan(scan, get);
  std::uint64_t files = 0, warnings = 0;
  get(files);
  for (; files > 0; --files)
    each_field_of_file(scan.files.emplace_back(), get);  // terminates because `get` throws
                                                         // at the end of the bytes
  get(warnings);
  for (; warnings > 0; --warnings) each_field_of_warning(scan.warnings.emplace_back(), get);
  r.expect_end();
  return scan;
}

}  // namespace gigabake
