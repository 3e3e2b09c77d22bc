#include "cluster/watch/bake_watch.h"

#include <algorithm>
#include <bit>
#include <iterator>
#include <system_error>
#include <utility>

#include "cluster/bake/output_folder.h"
#include "cluster/bake/status_feed.h"
#include "core/base/error.h"
#include "core/octree/brick.h"
#include "format/scene/paged_scene.h"

namespace gigabake {
namespace {

namespace fs = std::filesystem;

constexpr double observe_every_s = 1;

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

/// Returns whether cells of both scenes can be shown together.
bool are_compatible(const SceneHeader& a, const SceneHeader& b) {
  return a.voxel_size_m == b.voxel_size_m && a.lattice_origin_m == b.lattice_origin_m && a.origin == b.origin &&
         a.has_normals == b.has_normals && a.has_directional_coverage == b.has_directional_coverage &&
         a.has_classes == b.has_classes;
}

/// Returns the previous scene; nullopt if it does not exist or cannot be shown together with the planned scene.
std::optional<SceneDescription> previous_scene(const fs::path& scene_xml, const SceneDescription& planned) {
  if (!is_file(scene_xml) || planned.cells.empty()) return std::nullopt;
  try {
    const PagedScene scene(scene_xml);
    if (!are_compatible(scene.header(), planned) || scene.totals().cell_voxels != planned.cells[0].cell_voxels)
      return std::nullopt;
    return scene.all();
  } catch (const InputError&) {
    return std::nullopt;
  }
}

/// Returns the planned cell without a shard.
SceneCell unbaked(SceneCell cell) {
  cell.file.clear();
  cell.lods = std::uint32_t(std::bit_width(cell.cell_voxels / std::uint32_t(brick_edge)));
  return cell;
}

std::array<std::int64_t, 2> column_of(const SceneCell& cell) { return {cell.lattice_min[0], cell.lattice_min[1]}; }

}  // namespace

BakeWatch::BakeWatch(fs::path out, std::size_t few_cells) : out_(std::move(out)), few_cells_(few_cells) {}

const WatchedScene* BakeWatch::poll(std::vector<std::uint32_t>& changed) {
  const std::lock_guard lock(mutex_);
  changed.clear();  // changed_ may have cells of a call that ended by an error
  if (!shows_plan()) {
    started_s_ = -1;
    return nullptr;
  }
  const bool is_new = started_s_ != status_->status.started_s;
  if (is_new && !load_plan()) return nullptr;
  journal_->read_new([this](const Hash128& fingerprint, const CellReport& report) { take(fingerprint, report); });
  if (looks_for_shards_) take_unseen();
  take_failures();
  take_running();
  if (!is_new) {
    std::sort(changed_.begin(), changed_.end());
    std::unique_copy(changed_.begin(), changed_.end(), std::back_inserter(changed));
  }
  changed_.clear();
  if (is_new) is_small_change_ = changes_little();
  return is_small_change_ ? nullptr : &watched_;
}

/// Returns whether few cells of the plan are not done, and a published scene shows the others.
bool BakeWatch::changes_little() const {
  const auto open =
      std::size_t(std::ranges::count_if(watched_.states, [](CellState state) { return state != CellState::done; }));
  return open <= std::max(few_cells_, few_cells_ * watched_.states.size() / 64) && is_file(out_ / "scene.xml");
}

/// Observes the status if it was replaced, or once a second, since the bake may have died. Returns whether the plan is
/// that of the bake and should be shown.
bool BakeWatch::shows_plan() {
  const std::optional<FileStamp> stamp = stamp_of(status_file(out_));
  const double now_s = unix_now_s();
  if (!stamp || *stamp != status_stamp_ || now_s - observed_s_ >= observe_every_s || now_s < observed_s_) {
    observed_s_ = now_s;
    looks_for_shards_ = true;
    status_stamp_ = stamp.value_or(FileStamp{});
    try {
      status_ = observe_status(out_);
    } catch (const InputError&) {
      status_.reset();
    }
  }
  if (!status_ || status_->status.state == BakeState::scanning) return false;
  return status_->is_running() || !is_file(out_ / "scene.xml");
}

/// Loads the plan; returns false if there is none.
bool BakeWatch::load_plan() {
  started_s_ = -1;
  if (!is_file(plan_file_of(out_))) return false;
  StoredPlan stored = read_plan_record(plan_file_of(out_));
  plan_ = std::move(stored.record);
  failures_at_ = stored.end;
  watched_ = {watched_.bake + 1, {}, {}};
  static_cast<SceneHeader&>(watched_.scene) = plan_.header;
  for (const SceneCell& cell : plan_.cells) watched_.scene.cells.push_back(unbaked(cell));
  watched_.states.assign(plan_.cells.size(), CellState::waiting);
  finished_.assign(plan_.cells.size(), {});
  errors_.clear();
  baking_.clear();
  unseen_.clear();
  index_cells();
  add_previous();
  journal_.emplace(journal_of(out_));
  started_s_ = status_->status.started_s;
  return true;
}

void BakeWatch::index_cells() {
  by_fingerprint_.clear();
  by_name_.clear();
  columns_.clear();
  for (std::uint32_t i = 0; i < plan_.cells.size(); ++i) {
    const SceneCell& cell = plan_.cells[i];
    by_fingerprint_[cell.fingerprint] = i;
    by_name_[cell.name] = i;
    columns_[column_of(cell)][cell.lattice_min[2]] = i;
  }
}

void BakeWatch::add_previous() {
  const std::optional<SceneDescription> previous = previous_scene(out_ / "scene.xml", watched_.scene);
  if (!previous) return;
  for (const SceneCell& cell : previous->cells) add_previous_cell(cell);
}

/// Shows a cell of the previous scene until the planned cell at its place is done. Without a planned cell that overlaps
/// it, shows it until the new scene is published.
void BakeWatch::add_previous_cell(const SceneCell& cell) {
  const auto column = columns_.find(column_of(cell));
  const auto at = column == columns_.end() ? std::map<std::int64_t, std::uint32_t>::const_iterator()
                                           : column->second.find(cell.lattice_min[2]);
  if (column != columns_.end() && at != column->second.end()) {
    watched_.scene.cells[at->second] = cell;
  } else if (!overlaps_planned(cell)) {
    watched_.scene.cells.push_back(cell);
    watched_.states.push_back(CellState::done);
  }
}

bool BakeWatch::overlaps_planned(const SceneCell& cell) const {
  const auto column = columns_.find(column_of(cell));
  if (column == columns_.end()) return false;
  const std::int64_t low = cell.lattice_min[2], edge = cell.cell_voxels;
  const auto above = column->second.upper_bound(low - edge);
  return above != column->second.end() && above->first < low + edge;
}

bool BakeWatch::has_shard(const SceneCell& planned, const SceneCell& baked) const {
  if (baked.file != planned.file || baked.lattice_min != planned.lattice_min ||
      baked.cell_voxels != planned.cell_voxels || fs::path(baked.name).has_parent_path())
    return false;
  std::error_code error;
  return fs::file_size(out_ / baked.file, error) == baked.bytes && !error;
}

void BakeWatch::take(const Hash128& fingerprint, const CellReport& report) {
  const auto found = by_fingerprint_.find(fingerprint);
  if (found == by_fingerprint_.end()) return;
  const std::uint32_t cell = found->second;
  const bool is_baked = report.outcome == CellOutcome::baked;
  if (is_baked && !has_shard(plan_.cells[cell], report.cell)) {
    unseen_.insert_or_assign(fingerprint, report);  // this host does not see it yet, or it is baked again
    return;
  }
  if (!is_baked && report.outcome != CellOutcome::empty) return;
  if (watched_.states[cell] == CellState::done && finished_[cell].shard == report.shard) return;
  finished_[cell] = {report.shard, report.read_s + report.kernel_s + report.write_s,
                     is_baked ? report.cell.own_voxels() : 0};
  watched_.scene.cells[cell] = is_baked ? report.cell : unbaked(plan_.cells[cell]);
  watched_.states[cell] = CellState::done;
  changed_.push_back(cell);
}

/// Looks again for the shards that were not found.
void BakeWatch::take_unseen() {
  looks_for_shards_ = false;
  for (const auto& [fingerprint, report] : std::exchange(unseen_, {})) take(fingerprint, report);
}

void BakeWatch::take_failures() {
  for (FailedCell& failed : read_failed_cells(plan_file_of(out_), failures_at_)) {
    if (failed.cell >= plan_.cells.size()) continue;
    errors_[failed.cell] = std::move(failed.error);
    set_state(failed.cell, CellState::failed);
  }
}

void BakeWatch::take_running() {
  std::vector<std::uint32_t> now;
  if (status_->is_running())
    for (const WorkerStatus& worker : status_->status.workers)
      for (const std::string& name : worker.cells)
        if (const auto cell = by_name_.find(name); cell != by_name_.end()) now.push_back(cell->second);
  std::sort(now.begin(), now.end());
  for (const std::uint32_t cell : baking_)
    if (watched_.states[cell] == CellState::baking && !std::binary_search(now.begin(), now.end(), cell))
      set_state(cell, CellState::waiting);
  for (const std::uint32_t cell : now)
    if (watched_.states[cell] == CellState::waiting) set_state(cell, CellState::baking);
  baking_ = std::move(now);
}

void BakeWatch::set_state(std::uint32_t cell, CellState state) {
  if (std::exchange(watched_.states[cell], state) != state) changed_.push_back(cell);
}

CellFacts BakeWatch::facts(std::uint32_t cell) const {
  const std::lock_guard lock(mutex_);
  CellFacts facts;
  if (cell >= watched_.states.size()) return facts;
  const SceneCell& shown = watched_.scene.cells[cell];
  facts.name = shown.name;
  facts.state = watched_.states[cell];
  facts.triangles = shown.triangles;
  if (cell >= plan_.cells.size()) return facts;  // a cell of the previous scene only
  double all = 0;
  for (const SceneCell& planned : plan_.cells) all += double(planned.triangles);
  facts.name = plan_.cells[cell].name;
  if (facts.state != CellState::done) facts.triangles = plan_.cells[cell].triangles;
  facts.cost = all > 0 ? double(plan_.cells[cell].triangles) / all : 0;
  facts.seconds = finished_[cell].seconds;
  facts.voxels = finished_[cell].voxels;
  for (const std::uint32_t tile : plan_.tiles[cell])
    if (tile < plan_.tile_names.size()) facts.tiles.push_back(plan_.tile_names[tile]);
  if (const auto error = errors_.find(cell); error != errors_.end()) facts.error = error->second;
  return facts;
}

}  // namespace gigabake
