#include "format/export/voxel_tiles/tileset_record.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "format/system/read_file.h"

namespace gigabake {
namespace {

using RecordJson = nlohmann::ordered_json;

constexpr const char* record_format = "gigabake voxel tileset";
constexpr int record_version = 2;  ///< version of the record's format and of the tiles' format

template <std::size_t n>
void put_bytes(RecordJson& row, const std::array<std::uint8_t, n>& bytes) {
  for (const std::uint8_t b : bytes) row.push_back(b);
}

template <std::size_t n>
void get_bytes(const RecordJson& row, std::size_t& at, std::array<std::uint8_t, n>& bytes) {
  for (std::uint8_t& b : bytes) {
    const auto value = row.at(at++).get<std::uint64_t>();
    if (value > 255) throw std::out_of_range("a byte is above 255");
    b = std::uint8_t(value);
  }
}

RecordJson row_of(const TilePlace& tile, const TileRecord& record) {
  const VoxelStatistics& s = record.statistics;
  RecordJson row = {tile.level, tile.key, record.made_of.hex(), s.voxels, record.bytes, record.checksum.hex()};
  put_bytes(row, s.min_rgba);
  put_bytes(row, s.max_rgba);
  put_bytes(row, s.min_normal);
  put_bytes(row, s.max_normal);
  if (s.min_class > s.max_class) return row;  // no classes
  row.push_back(s.min_class);
  row.push_back(s.max_class);
  return row;
}

/// Parses the record of one tile.
/// Errors  std::exception: the record is malformed.
std::pair<TilePlace, TileRecord> tile_of(const RecordJson& row) {
  TilePlace tile{row.at(0).get<std::uint32_t>(), row.at(1).get<std::uint64_t>()};
  TileRecord record;
  record.made_of = Hash128::from_hex(row.at(2).get<std::string>()).value();
  record.statistics.voxels = row.at(3).get<std::uint64_t>();
  record.bytes = row.at(4).get<std::uint64_t>();
  record.checksum = Hash128::from_hex(row.at(5).get<std::string>()).value();
  std::size_t at = 6;
  get_bytes(row, at, record.statistics.min_rgba);
  get_bytes(row, at, record.statistics.max_rgba);
  get_bytes(row, at, record.statistics.min_normal);
  get_bytes(row, at, record.statistics.max_normal);
  if (row.size() == at) return {tile, record};  // no classes
  record.statistics.min_class = row.at(at).get<VoxelClass>();
  record.statistics.max_class = row.at(at + 1).get<VoxelClass>();
  return {tile, record};
}

/// Returns whether `file`, a path relative to the folder, is a name that exports give to their files.
bool is_exported(const std::filesystem::path& file) {
  const std::string name = file.generic_string();
  const bool is_tile = name.starts_with("tiles/") && name.ends_with(".glb");
  const bool is_subtree =
      name.starts_with("subtrees/") && (name.ends_with(".subtree") || name.ends_with(".subtree.glb"));
  return is_tile || is_subtree || name == record_name || name == "tileset.json" || name == "tileset.gltf" ||
         name == "index.html";
}

}  // namespace

std::string rule_of(const SceneHeader& scene, const VoxelTiling& tiling, const std::string& form) {
  RecordJson rule = {{"form", form},
                     {"voxel_size_m", scene.voxel_size_m},
                     {"lattice_origin_m", scene.lattice_origin_m},
                     {"normals", scene.has_normals},
                     {"corner", tiling.corner},
                     {"edge", tiling.edge},
                     {"levels", tiling.levels},
                     {"finest", tiling.finest}};
  if (scene.has_classes) rule["classes"] = true;
  if (scene.origin) rule["origin"] = {scene.origin->latitude_deg, scene.origin->longitude_deg, scene.origin->height_m};
  return rule.dump();
}

std::string record_text(const TilesetRecord& record) {
  const RecordJson head = {{"format", record_format}, {"version", record_version}, {"rule", record.rule}};
  std::string text = head.dump();
  text.back() = ',';
  text += "\n\"tiles\":[";
  const char* between = "\n";
  for (const auto& [tile, of_tile] : record.tiles) {
    text += between + row_of(tile, of_tile).dump();
    between = ",\n";
  }
  return text + "\n]}\n";
}

void expect_only_exported_files(const std::filesystem::path& folder) {
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::filesystem::path file = entry.path().lexically_relative(folder);
    if (!entry.is_directory() && !is_exported(file))
      throw InputError(folder, file.string(),
                       "is not a file of an export, and `update` replaces the folder; move the file elsewhere");
  }
}

TilesetRecord read_record(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / record_name;
  if (!std::filesystem::is_regular_file(file))
    throw InputError(folder, record_name,
                     "is missing: the folder is not a voxel tileset of an earlier export; name another folder");
  const std::vector<std::uint8_t> bytes = read_whole_file(file);
  try {
    const RecordJson json = RecordJson::parse(bytes.begin(), bytes.end());
    if (json.at("format") != record_format) throw std::out_of_range("another format");
    TilesetRecord record;
    if (json.at("version") != record_version) return record;  // tiles of another version are not reused
    record.rule = json.at("rule").get<std::string>();
    for (const RecordJson& row : json.at("tiles")) record.tiles.insert(tile_of(row));
    return record;
  } catch (const InputError&) {
    throw;
  } catch (const std::exception&) {
    throw InputError(file, "", "is damaged: remove the folder and export without `update`");
  }
}

}  // namespace gigabake
