#include "format/export/voxel_tiles/voxel_tileset.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/io/bytes.h"
#include "format/export/voxel_tiles/archive_3tz.h"
#include "format/export/voxel_tiles/implicit_octree.h"
#include "format/export/voxel_tiles/tile_stats.h"
#include "format/export/voxel_tiles/tile_writer.h"
#include "format/export/voxel_tiles/tileset_json.h"
#include "format/export/voxel_tiles/tileset_page.h"
#include "format/export/voxel_tiles/tileset_record.h"
#include "format/system/output_file.h"
#include "format/system/publish_folder.h"

namespace gigabake {
namespace {

constexpr std::uint64_t level_cache_bytes = std::uint64_t(256) << 20;
/// Number of tiles between a tile that is written and the tile whose levels are read at the same time. A level takes as
/// long as about four tiles. Otherwise all threads would wait for a level that one of them reads.
constexpr std::size_t tiles_ahead_per_thread = 8;

/// Returns this rank's tiles. Each block of 2³ tiles is assigned to the rank with the smallest load. Tiles of a block
/// stay together, because they read the same shards.
std::vector<TilePlace> share_of(const TileWeights& tiles, const ExportTeam& team) {
  std::vector<std::uint64_t> load(std::size_t(team.ranks()));
  std::vector<TilePlace> own;
  TilePlace block{~std::uint32_t(0), 0};
  std::size_t rank = 0;
  constexpr std::uint64_t of_tile = 60;  // cost of a tile without bricks; the unit is the cost of a brick
  for (auto tile = tiles.rbegin(); tile != tiles.rend(); ++tile) {
    const TilePlace in{tile->first.level, tile->first.key >> 3};
    if (in != block) rank = std::size_t(std::min_element(load.begin(), load.end()) - load.begin());
    block = in;
    load[rank] += tile->second + of_tile;
    if (rank == std::size_t(team.rank())) own.push_back(tile->first);
  }
  return own;
}

struct FolderFiles {
  const std::filesystem::path &target, &folder;

  void write(const std::string& name, std::span<const std::uint8_t> bytes) const {
    OutputFile out(target, folder / name);
    out.write(bytes);
    out.finish();
  }
  void write(const std::string& name, const std::string& text) const {
    write(name, std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
  }
};

/// The box to which the cube of the octree is fitted. Coarse voxels of a bake contain voxels of the finest level, so
/// the bricks of this level suffice. Shards of other programs may have coarse voxels outside of these bricks.
enum class Fit { bricks_of_finest, windows_of_cells };

class TilesetExport {
 public:
  TilesetExport(const PagedScene& scene, const TilesetOptions& options, Fit fit, const Progress& progress,
                const ExportTeam& team)
      : scene_(scene), progress_(progress), team_(team), pool_(options.threads), owners_(scene), form_(options.form) {
    const TileStats stats(scene_, owners_, team_, pool_, progress_);
    bounds_ = fit == Fit::bricks_of_finest ? stats.bounds(options.lod) : scene.totals().window;
    if (bounds_.is_empty()) throw InputError(scene.file(), "Voxels", "the level has no voxels");
    tiling_ = tiling_of(bounds_, options.lod, options.tile_voxels);
    if (tiling_.levels > max_tile_levels)
      throw InputError(scene.file(), "LatticeMin", "cells are too far apart for one oct-tree");
    team_.together([&] { made_.emplace(scene_, owners_, tiling_.coarsest()); });
    weights_ = stats.tiles(tiling_, *made_);
  }

  /// Writes the tiles of all ranks. Collective call. `before` is the record of an earlier export at `target`.
  void write_tiles(const std::filesystem::path& target, const std::filesystem::path& folder,
                   const TilesetRecord& before) {
    ShardLevels levels(scene_, level_cache_bytes);
    const TileSource source{scene_, owners_, *made_, tiling_, levels, form_};
    std::vector<std::unique_ptr<TileWriter>> writers;
    for (int t = 0; t < pool_.threads(); ++t) writers.push_back(std::make_unique<TileWriter>(source, target, folder));
    const std::vector<TilePlace> own = share_of(weights_, team_);
    std::vector<TileRecord> written(own.size());
    const TileRecords none;
    const TileRecords& known = before.rule == rule() ? before.tiles : none;
    progress_.step("writing tiles", own.size(), "tile");
    team_.together([&] {
      const std::size_t ahead = tiles_ahead_per_thread * std::size_t(pool_.threads());
      pool_.parallel_for(own.size(), 1, [&](std::size_t i, std::size_t, int thread) {
        TileWriter& writer = *writers[std::size_t(thread)];
        // Tiles of an earlier export may need no levels.
        if (known.empty() && pool_.threads() > 1 && i + ahead < own.size()) writer.read_ahead(own[i + ahead]);
        written[i] = write_tile(writer, own[i], known, target);
        progress_.advance();
      });
    });
    collect(own, written);
    team_.together([&] { add_missing_parents(team_.rank() == 0 ? writers[0].get() : nullptr); });
  }

  /// Returns whether the tiles of each level have as many voxels as the scene records. Skips derived levels. Skips
  /// levels that may not be aligned with the lattice, because rounding down can merge two of their voxels.
  bool has_all_voxels() const {
    std::map<int, std::uint64_t> voxels;
    for (const auto& [tile, record] : tiles_) voxels[tiling_.lod(tile.level)] += record.statistics.voxels;
    constexpr int always_on_lattice = 3;
    for (const auto& [lod, count] : voxels) {
      const bool is_known = !made_->has(lod) && (lod <= always_on_lattice || owners_.has_overviews());
      if (is_known && count != described_voxels(scene_, lod)) return false;
    }
    return true;
  }

  /// Writes the tileset's JSON document and its subtree files. Called on rank 0.
  void write_documents(const std::filesystem::path& target, const std::filesystem::path& folder) const {
    const FolderFiles files{target, folder};
    TileLevels tiles(tiling_.levels);
    TilesetSummary summary{tiles_.size(), {}, bounds_};
    for (const auto& [tile, record] : tiles_) {
      tiles[tile.level].push_back(tile.key);
      summary.voxels.add(record.statistics);
    }
    const bool is_gltf = form_ == TilesetForm::gltf_2_1;
    for (std::uint32_t level = 0; level < tiling_.levels; level += subtree_levels(tiling_.levels))
      for (const std::uint64_t root : tiles[level]) {
        const std::string name = "subtrees/" + path_of({level, root}) + ".subtree";
        if (is_gltf)
          files.write(name + ".glb", subtree_glb(tiles, level, root));
        else
          files.write(name, subtree_file(tiles, level, root));
      }
    if (is_gltf)
      files.write("tileset.gltf", tileset_gltf(scene_.header(), tiling_, summary));
    else
      files.write("tileset.json", tileset_json(scene_.header(), tiling_, summary));
  }

  /// Writes the record and the web page. Called on rank 0.
  void write_extras(const std::filesystem::path& target, const std::filesystem::path& folder) const {
    const FolderFiles files{target, folder};
    files.write(record_name, record_text({rule(), tiles_}));
    if (form_ == TilesetForm::tiles_1_1) files.write("index.html", std::string(tileset_page));
  }

 private:
  std::string rule() const {
    return rule_of(scene_.header(), tiling_, form_ == TilesetForm::gltf_2_1 ? "gltf 2.1" : "3d tiles 1.1");
  }

  static TileRecord write_tile(TileWriter& writer, const TilePlace& tile, const TileRecords& known,
                               const std::filesystem::path& before) {
    const std::optional<Hash128> made_of = writer.made_of(tile);
    const auto same = known.find(tile);
    const bool is_same = made_of && same != known.end() && same->second.made_of == *made_of;
    if (is_same && writer.take_over(tile, same->second, before)) return same->second;
    TileRecord record = writer.write(tile);
    record.made_of = made_of.value_or(Hash128{});
    return record;
  }

  void collect(const std::vector<TilePlace>& own, const std::vector<TileRecord>& written) {
    ByteWriter writer;
    writer.put(std::uint64_t(own.size()));
    for (std::size_t i = 0; i < own.size(); ++i) {
      writer.put(own[i].level);
      writer.put(own[i].key);
      writer.put(written[i]);
    }
    for (const std::vector<std::uint8_t>& bytes : team_.exchange(writer.take())) {
      ByteReader reader(bytes, "written tiles of a rank");
      std::uint64_t count = 0;
      reader.get(count);
      for (; count > 0; --count) {
        TilePlace tile;
        reader.get(tile.level);
        reader.get(tile.key);
        reader.get(tiles_[tile]);
      }
    }
  }

  /// Adds a tile without voxels wherever a tile lacks its parent, because a tree must not have gaps.
  void add_missing_parents(TileWriter* writer) {
    for (std::uint32_t level = tiling_.levels - 1; level > 0; --level)
      for (auto tile = tiles_.lower_bound({level, 0}); tile != tiles_.end() && tile->first.level == level; ++tile) {
        const TilePlace parent{level - 1, tile->first.key >> 3};
        const auto [added, is_new] = tiles_.try_emplace(parent);
        if (is_new && writer != nullptr) added->second = writer->write_empty(parent);
      }
  }

  const PagedScene& scene_;
  const Progress& progress_;
  const ExportTeam& team_;
  ThreadPool pool_;
  LevelOwners owners_;
  TilesetForm form_;
  Box3i64 bounds_;
  VoxelTiling tiling_;
  std::optional<DerivedLevels> made_;
  TileWeights weights_;
  TileRecords tiles_;
};

/// Returns rank 0's path on every rank.
std::filesystem::path shared_path(const ExportTeam& team, const std::filesystem::path& own) {
  ByteWriter writer;
  writer.put(own.string());
  std::string path;
  ByteReader(team.exchange(writer.take()).front(), "a path of rank 0").get(path);
  return path;
}

}  // namespace

std::uint64_t export_3dtiles(const std::filesystem::path& scene_xml, const TilesetOptions& options,
                             const std::filesystem::path& target, const Progress& progress, const ExportTeam& team) {
  const bool is_archive = target.extension() == ".3tz";
  std::optional<SceneLevel> level;
  std::optional<FolderPublication> publication;  // set on rank 0
  TilesetRecord before;
  if (is_archive && options.update) throw UsageError("update", "an archive cannot be updated; expected a folder");
  team.together([&] {
    level.emplace(open_scene_level(scene_xml, options.lod));
    if (level->scene.totals().cells == 0) throw InputError(scene_xml, "PagedOctTree", "the scene has no cells");
    if (options.update) before = read_record(target);
    if (options.update) expect_only_exported_files(target);
    if (!options.update && std::filesystem::exists(target / record_name))
      throw InputError(target, "", "is an export already; use `update`, or name another folder");
    if (team.rank() == 0) publication.emplace(target, options.update ? Replaces::a_folder : Replaces::nothing);
  });
  const std::filesystem::path temporary = shared_path(team, publication ? publication->temporary() : "");
  std::optional<TilesetExport> tileset;
  for (const Fit fit : {Fit::bricks_of_finest, Fit::windows_of_cells}) {
    team.together([&] {
      if (publication) std::filesystem::remove_all(temporary / "tiles");
    });
    tileset.emplace(level->scene, options, fit, progress, team);
    tileset->write_tiles(target, temporary, before);
    if (tileset->has_all_voxels()) break;
  }
  team.together([&] {
    if (!publication) return;
    if (!tileset->has_all_voxels())
      throw InputError(scene_xml, "Voxels", "the number of voxels in the shards differs from scene.xml");
    tileset->write_documents(target, temporary);
    if (!is_archive) tileset->write_extras(target, temporary);
    is_archive ? write_archive_3tz(temporary, publication->target(), progress) : publication->publish();
  });
  return level->voxels;
}

}  // namespace gigabake
