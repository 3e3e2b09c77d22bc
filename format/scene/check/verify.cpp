#include "format/scene/check/verify.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>
#include <optional>

#include "core/base/error.h"
#include "core/base/pluralize.h"
#include "core/base/thread_pool.h"
#include "format/scene/cell_window.h"
#include "format/scene/check/scene_check.h"
#include "format/scene/paged_scene.h"
#include "format/scene/shard_of_scene.h"
#include "format/scene/tier_shape.h"
#include "format/shard/levels/brick_walk.h"
#include "format/shard/levels/content_hash.h"
#include "format/shard/shard_reader.h"

namespace gigabake {
namespace {

/// The faults of one file.
class Faults {
 public:
  explicit Faults(std::filesystem::path file) : file_(std::move(file)) {}
  void expect(bool holds, const std::string& key, const std::string& message) {
    if (!holds) lines.emplace_back(InputError(file_, key, message).what());
  }
  std::vector<std::string> lines;

 private:
  std::filesystem::path file_;
};

void check_voxels(const Shard& shard, const SceneCell& cell, Faults& faults) {
  const std::vector<std::uint64_t> voxels = count_voxels(shard);
  const std::vector<Hash128> hash = content_hash(shard);
  for (std::size_t lod = 0; lod < voxels.size(); ++lod) {
    const std::string level = "/lod_" + std::to_string(lod);
    faults.expect(lod < cell.voxels.size() && voxels[lod] == cell.voxels[lod], level,
                  "holds " + pluralize(voxels[lod], "voxel") + ", but scene.xml has another number");
    faults.expect(hash[lod] == shard.header.content_hash[lod], level,
                  "the voxels do not match the shard's content_hash");
  }
}

/// Reads a whole shard; returns nullopt if it is damaged. Then adds a line per damaged dataset to `faults` or, if all
/// datasets are readable, a line with the violated rule.
std::optional<Shard> read_whole(ShardReader& reader, Faults& faults) {
  faults.lines = reader.check_chunk_table();
  if (!faults.lines.empty()) return std::nullopt;
  try {
    return reader.all();
  } catch (const InputError& error) {
    faults.lines = reader.unreadable_columns();
    if (faults.lines.empty()) faults.lines.emplace_back(error.what());
    return std::nullopt;
  }
}

void check_stored(const ShardReader& reader, const SceneCell& cell, Faults& faults) {
  const char* const differs = "of the columns differ from scene.xml";
  for (std::size_t lod = 0; lod < std::min(cell.level_bytes.size(), std::size_t(reader.header().lods)); ++lod)
    faults.expect(reader.level_bytes(int(lod)) == cell.level_bytes[lod], "LevelBytes", differs);
  faults.expect(reader.node_bytes() == cell.node_bytes, "NodeBytes", differs);
}

std::vector<std::string> check_cell(const SceneHeader& scene, const SceneCell& cell,
                                    const std::filesystem::path& path) {
  Faults faults(path);
  try {
    ShardReader reader(path);
    if (const auto shard = read_whole(reader, faults)) check_voxels(*shard, cell, faults);
    for (const auto& [attribute, what] : differences_from_scene(reader.header(), scene, cell))
      faults.expect(false, attribute, what);
    if (!cell.level_bytes.empty()) check_stored(reader, cell, faults);
    const std::uint64_t bytes = std::filesystem::file_size(path);
    faults.expect(bytes == cell.bytes, "Bytes",
                  "the file has " + std::to_string(bytes) + ", scene.xml states " + std::to_string(cell.bytes));
  } catch (const std::exception& error) {
    faults.lines.emplace_back(error.what());
  }
  return faults.lines;
}

std::vector<std::string> lines_of(const std::filesystem::path& file, const std::vector<SceneFault>& faults) {
  std::vector<std::string> lines;
  for (const SceneFault& fault : faults) lines.emplace_back(error_of(file, fault).what());
  return lines;
}

void add_lines(std::vector<std::string> lines, std::vector<std::string>& to) {
  std::move(lines.begin(), lines.end(), std::back_inserter(to));
}

std::uint64_t hash_of_name(const SceneCell& cell) { return std::hash<std::string>()(cell.name); }

/// A verification of one scene. Pages are checked one after the other; the cells of a page and the overviews use all
/// threads.
class SceneVerification {
 public:
  SceneVerification(const std::filesystem::path& scene_xml, int threads, const Progress& progress,
                    const OverviewCheck& check_overview)
      : scene_xml_(scene_xml), pool_(threads), progress_(progress), check_overview_(check_overview) {}

  VerifyResult run() {
    progress_.step("reading the scene");
    SceneReading reading = read_scene_text(scene_xml_);
    result_.has_totals = reading.said.has_value();
    const std::vector<SceneFault> listed = faults_of_listed(reading);
    for (const auto& faults : {reading.faults, faults_of_parameters(reading), listed})
      add_lines(lines_of(scene_xml_, faults), result_.faults);
    header_ = reading.scene;
    version_ = reading.version;
    std::uint64_t all_bytes = SceneTotals(reading.scene).bytes;
    for (const PageReference& page : reading.pages) all_bytes += page.totals.bytes;
    progress_.step("checking the shards", all_bytes);
    add_lines(lines_of(scene_xml_, overlaps_of_cells(reading.scene.cells)), result_.faults);
    check_cells(reading.scene.cells);
    check_cells(reading.scene.overviews);
    for (const SceneCell& overview : reading.scene.overviews) names_.push_back(hash_of_name(overview));
    if (listed.empty()) pages_.emplace(scene_xml_);
    for (const PageReference& page : reading.pages) check_page(page);
    if (!reading.pages.empty()) check_names();
    if (pages_) check_above();
    result_.missing = missing_data(header_, result_.cells);
    return std::move(result_);
  }

 private:
  /// Checks the overview levels and the overviews. Holds all overviews in memory, a few per hundred cells.
  void check_above() {
    std::vector<SceneCell> overviews;
    try {
      overviews = pages_->overviews();
      check_tiers(overviews);
    } catch (const InputError&) {
      return;  // A page is damaged; the check of that page reports it.
    }
    if (check_overview_) check_overviews(overviews);
  }

  /// Checks the attribute ParentTiers. Viewers find overviews by this attribute; without it, they must list all cells.
  /// It must therefore exist whenever all cells have one root, and be correct.
  void check_tiers(const std::vector<SceneCell>& overviews) {
    if (version_ < 5) return;
    const CellWalk walk = [this](const auto& visit) { pages_->for_each_cell(visit); };
    const std::vector<TierShape> expected = tiers_of(overviews, header_, pages_->totals().cell_voxels, walk);
    if (header_.tiers.empty() && expected.empty()) return;
    if (header_.tiers.empty())
      result_.faults.emplace_back(
          InputError(scene_xml_, "OctTreeGroup ParentTiers", "is missing, although all cells have one root; bake again")
              .what());
    else if (expected != header_.tiers || !cover_cells(CellPart::some, overviews, header_.tiers.front(), walk))
      result_.faults.emplace_back(InputError(scene_xml_, "OctTreeGroup ParentTiers",
                                             "an overview of cells or overviews is missing, duplicated or not where it "
                                             "states; bake again")
                                      .what());
  }

  void check_page(const PageReference& reference) {
    const std::filesystem::path path = scene_xml_.parent_path() / reference.file;
    PageReading reading;
    try {
      reading = read_page_text(scene_xml_, header_, reference);
    } catch (const InputError& error) {
      return result_.faults.emplace_back(error.what()), void();
    }
    add_lines(lines_of(path, reading.faults), result_.faults);
    add_lines(lines_of(path, reading.contradictions), result_.faults);
    if (!reading.contradictions.empty()) return;  // references below may lead to wrong files
    check_overlaps(path, reference);
    for (const auto& shards : {&reading.page.cells, &reading.page.overviews}) {
      check_cells(*shards);
      for (const SceneCell& shard : *shards) names_.push_back(hash_of_name(shard));
    }
    for (const PageReference& below : reading.page.pages) check_page(below);
  }

  /// Reports cells of a page that overlap other cells. Also compares them with cells of neighbouring pages, because a
  /// cell may extend beyond the block of its page.
  void check_overlaps(const std::filesystem::path& path, const PageReference& page) {
    if (!pages_ || page.groups != 0) return;
    try {
      const std::vector<SceneCell> near = pages_->cells_in(page.totals.window);
      add_lines(lines_of(path, overlaps_of_cells(near, &page.block)), result_.faults);
    } catch (const InputError&) {
      // A neighbouring page is damaged; the check of that page reports it.
    }
  }

  /// Finds duplicate names across pages. Names within one page were compared before.
  void check_names() {
    std::sort(names_.begin(), names_.end());
    std::vector<std::uint64_t> twice;
    for (std::size_t i = 1; i < names_.size(); ++i)
      if (names_[i] == names_[i - 1]) twice.push_back(names_[i]);
    if (twice.empty() || !pages_) return;
    pages_->for_each_cell([&](const SceneCell& cell) {
      if (std::binary_search(twice.begin(), twice.end(), hash_of_name(cell)))
        result_.faults.emplace_back(InputError(scene_xml_, "PagedOctTree " + as_line(cell.name, max_quote_bytes),
                                               "another cell has the same name")
                                        .what());
    });
  }

  void check_cells(const std::vector<SceneCell>& cells) {
    std::vector<std::vector<std::string>> of_cell(cells.size());
    pool_.parallel_for(cells.size(), 1, [&](std::size_t i, std::size_t, int) {
      of_cell[i] = check_cell(header_, cells[i], scene_xml_.parent_path() / cells[i].file);
      progress_.advance(cells[i].bytes);
    });
    for (std::size_t i = 0; i < cells.size(); ++i) {
      result_.cells += cells[i].first_lod == 0;
      result_.bytes += cells[i].bytes;
      result_.voxels += cells[i].own_voxels();
      add_lines(std::move(of_cell[i]), result_.faults);
    }
  }

  /// Checks each overview with the shards directly below it: cells, or the overviews of one level.
  void check_overviews(const std::vector<SceneCell>& overviews) {
    std::map<std::uint32_t, std::vector<SceneCell>> tiers;  // key: the lod above their coarsest level
    for (const SceneCell& overview : overviews) tiers[overview.first_lod + overview.lods].push_back(overview);
    std::map<std::uint32_t, CellFinder> finders;
    for (const auto& [lod, tier] : tiers) finders.emplace(lod, CellFinder(tier));
    std::vector<std::vector<std::string>> of_overview(overviews.size());
    progress_.step("checking the overviews", overviews.size());
    pool_.parallel_for(overviews.size(), 1, [&](std::size_t i, std::size_t, int) {
      const auto below = finders.find(overviews[i].own_lod());
      std::optional<std::vector<SceneCell>> children;
      if (below == finders.end()) {
        children = cells_below(overviews[i]);
      } else {
        children.emplace();
        for (const std::size_t child : below->second.overlapping(window_of(overviews[i])))
          children->push_back(tiers.at(below->first)[child]);
      }
      if (children) of_overview[i] = check_overview_(header_, overviews[i], *children);
      progress_.advance();
    });
    for (std::vector<std::string>& lines : of_overview) add_lines(std::move(lines), result_.faults);
  }

  /// Returns the cells below an overview; nullopt if a page is damaged. The check of that page reports the damage.
  std::optional<std::vector<SceneCell>> cells_below(const SceneCell& overview) const {
    try {
      return pages_->cells_in(window_of(overview));
    } catch (const InputError&) {
      return std::nullopt;
    }
  }

  const std::filesystem::path& scene_xml_;
  ThreadPool pool_;
  const Progress& progress_;
  const OverviewCheck& check_overview_;
  SceneHeader header_;
  int version_ = 0;
  std::optional<PagedScene> pages_;   ///< only if scene.xml is consistent
  std::vector<std::uint64_t> names_;  ///< hashes of the shards' names: eight bytes per shard
  VerifyResult result_;
};

}  // namespace

VerifyResult verify_scene(const std::filesystem::path& scene_xml, int threads, const Progress& progress,
                          const OverviewCheck& check_overview) {
  return SceneVerification(scene_xml, threads, progress, check_overview).run();
}

}  // namespace gigabake
