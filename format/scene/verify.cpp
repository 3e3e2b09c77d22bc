#include "format/scene/verify.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "format/scene/scene_check.h"
#include "format/scene/shard_of_scene.h"
#include "format/shard/brick_walk.h"
#include "format/shard/content_hash.h"
#include "format/shard/shard_reader.h"
#include "lattice/counted.h"
#include "lattice/error.h"
#include "lattice/thread_pool.h"

namespace gigabake {
namespace {

/// Collects what is wrong with one file.
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
                  "holds " + counted(voxels[lod], "voxel") + ", scene.xml says otherwise");
    faults.expect(hash[lod] == shard.header.content_hash[lod], level,
                  "the voxels are not those of the shard's content_hash");
  }
}

/// Nothing where the shard is damaged; then every damaged dataset is listed, or else the rule that is broken.
std::optional<Shard> read_whole(const ShardReader& reader, Faults& faults) {
  try {
    return reader.all();
  } catch (const InputError& error) {
    faults.lines = reader.unreadable_columns();
    if (faults.lines.empty()) faults.lines.emplace_back(error.what());
    return std::nullopt;
  }
}

std::vector<std::string> check_cell(const SceneDescription& scene, const SceneCell& cell,
                                    const std::filesystem::path& path) {
  Faults faults(path);
  try {
    const ShardReader reader(path);
    if (const auto shard = read_whole(reader, faults)) check_voxels(*shard, cell, faults);
    for (const auto& [attribute, what] : differences_from_scene(reader.header(), scene, cell))
      faults.expect(false, attribute, what);
    const std::uint64_t bytes = std::filesystem::file_size(path);
    faults.expect(bytes == cell.bytes, "Bytes",
                  "the file has " + std::to_string(bytes) + ", scene.xml says " + std::to_string(cell.bytes));
  } catch (const std::exception& error) {
    faults.lines.emplace_back(error.what());
  }
  return faults.lines;
}

std::vector<std::string> check_scene(const std::filesystem::path& scene_xml, const SceneReading& reading) {
  std::vector<std::string> lines;
  for (const auto& faults :
       {reading.faults, faults_of_parameters(reading), faults_of_cells(reading), overlaps_of_cells(reading.scene)})
    for (const SceneFault& fault : faults) lines.emplace_back(error_of(scene_xml, fault).what());
  return lines;
}

}  // namespace

VerifyResult verify_scene(const std::filesystem::path& scene_xml, int threads, const Progress& progress) {
  progress.step("reading the scene");
  const SceneReading reading = read_scene_text(scene_xml);
  const SceneDescription& scene = reading.scene;
  VerifyResult result;
  result.has_totals = reading.said.has_value();
  result.faults = check_scene(scene_xml, reading);
  std::uint64_t all_bytes = 0;
  std::vector<const SceneCell*> shards;
  for (const auto& listed : {&scene.cells, &scene.parents})
    for (const SceneCell& cell : *listed) {
      shards.push_back(&cell);
      all_bytes += cell.bytes;
    }
  progress.step("checking the shards", all_bytes);
  std::vector<std::vector<std::string>> of_cell(shards.size());
  ThreadPool(threads).parallel_for(shards.size(), 1, [&](std::size_t i, std::size_t, int) {
    of_cell[i] = check_cell(scene, *shards[i], scene_xml.parent_path() / shards[i]->file);
    progress.advance(shards[i]->bytes);
  });
  for (std::size_t i = 0; i < shards.size(); ++i) {
    const SceneCell& cell = *shards[i];
    result.cells += cell.first_lod == 0;
    result.bytes += cell.bytes;
    result.voxels += std::accumulate(cell.voxels.begin(), cell.voxels.end(), std::uint64_t(0));
    result.faults.insert(result.faults.end(), of_cell[i].begin(), of_cell[i].end());
  }
  return result;
}

}  // namespace gigabake
