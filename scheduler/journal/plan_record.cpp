#include "scheduler/journal/plan_record.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <utility>

#include "core/base/error.h"
#include "core/io/bytes.h"
#include "format/system/publish.h"
#include "format/system/read_file.h"

namespace gigabake {
namespace {

constexpr std::string_view file_header = "gigabake plan 2\n";
constexpr std::uint64_t max_plan_bytes = std::uint64_t(1) << 40;

/// Calls `f` for each field of the record's header: ByteWriter::put to serialize, ByteReader::get to restore.
template <class Header, class F>
void each_field_of_header(Header& h, const F& f) {
  f(h.generator), f(h.voxel_size_m), f(h.lattice_origin_m), f(h.has_normals), f(h.has_directional_coverage),
      f(h.has_classes), f(h.parameters), f(h.bounds.min), f(h.bounds.end);
}

template <class Cell, class F>
void each_field_of_cell(Cell& c, const F& f) {
  f(c.name), f(c.lattice_min), f(c.cell_voxels), f(c.triangles), f(c.fingerprint);
}

std::vector<std::uint8_t> bytes_of(const PlanRecord& record) {
  ByteWriter w;
  const auto put = [&w](const auto& field) { w.put(field); };
  each_field_of_header(record.header, put);
  put(record.header.origin.has_value());
  put(record.header.origin.value_or(Geodetic{}));
  put(record.tile_names);
  put(std::uint64_t(record.cells.size()));
  for (std::size_t i = 0; i < record.cells.size(); ++i) {
    each_field_of_cell(record.cells[i], put);
    put(record.tiles[i]);
  }
  return w.take();
}

SceneCell read_cell(ByteReader& r) {
  CellJob job;
  each_field_of_cell(job, [&r](auto& field) { r.get(field); });
  return cell_of(job);
}

PlanRecord record_from(ByteReader& r) {
  PlanRecord record;
  const auto get = [&r](auto& field) { r.get(field); };
  each_field_of_header(record.header, get);
  bool has_origin = false;
  Geodetic origin;
  get(has_origin);
  get(origin);
  if (has_origin) record.header.origin = origin;
  get(record.tile_names);
  std::uint64_t cells = 0;
  get(cells);
  for (std::uint64_t i = 0; i < cells; ++i) {  // a wrong count ends at the end of the bytes
    record.cells.push_back(read_cell(r));
    get(record.tiles.emplace_back());
  }
  return record;
}

}  // namespace

PlanRecord plan_record_of(const std::vector<CellJob>& jobs, SceneHeader header, std::vector<std::string> tile_names) {
  PlanRecord record;
  record.header = std::move(header);
  record.tile_names = std::move(tile_names);
  for (const CellJob& job : jobs) {
    if (is_overview(job)) continue;
    record.cells.push_back(cell_of(job));
    record.tiles.push_back(job.tiles);
  }
  return record;
}

void write_plan_record(const std::filesystem::path& path, const PlanRecord& record) {
  const std::vector<std::uint8_t> payload = bytes_of(record);
  const std::uint64_t size = payload.size();
  std::string content(file_header);
  content.append(reinterpret_cast<const char*>(&size), sizeof size);
  content.append(reinterpret_cast<const char*>(payload.data()), payload.size());
  publish_file(path, content, Durability::while_up);
}

void append_failed_cell(const std::filesystem::path& path, const FailedCell& failed) {
  ByteWriter payload, whole;
  payload.put(failed.cell);
  payload.put(failed.error);
  whole.put(payload.take());  // with its length
  const Descriptor file(path, O_WRONLY | O_APPEND | O_NOFOLLOW);
  if (!file.is_open() && errno == ENOENT) return;
  if (!file.is_open() || !file.write_all(whole.take()))
    throw InputError(path, "", std::string("cannot write: ") + std::strerror(errno));
}

StoredPlan read_plan_record(const std::filesystem::path& path) {
  const std::vector<std::uint8_t> file = read_whole_file(path, max_plan_bytes);
  std::uint64_t size = 0;
  const std::size_t before = file_header.size() + sizeof size;
  if (file.size() < before || !std::equal(file_header.begin(), file_header.end(), file.begin()))
    throw InputError(path, "", "is not the plan of a bake of this version of gigabake");
  std::memcpy(&size, file.data() + file_header.size(), sizeof size);
  if (size > file.size() - before) throw InputError(path, "", "ends early");
  ByteReader r(std::span<const std::uint8_t>(file).subspan(before, size), "plan");
  StoredPlan stored{record_from(r), before + size};
  r.expect_end();
  return stored;
}

std::vector<FailedCell> read_failed_cells(const std::filesystem::path& path, std::uint64_t& at) {
  const std::vector<std::uint8_t> tail = read_tail(path, at).bytes;
  std::vector<FailedCell> found;
  std::size_t from = 0;
  for (std::uint64_t size = 0; tail.size() - from >= sizeof size; from += sizeof size + size) {
    std::memcpy(&size, tail.data() + from, sizeof size);
    if (size > tail.size() - from - sizeof size) break;  // is being written
    ByteReader r(std::span<const std::uint8_t>(tail).subspan(from + sizeof size, size), "plan");
    FailedCell& failed = found.emplace_back();
    r.get(failed.cell);
    r.get(failed.error);
    r.expect_end();
  }
  at += from;
  return found;
}

}  // namespace gigabake
