#include "format/verify.h"

#include <algorithm>
#include <mutex>
#include <numeric>
#include <set>

#include "format/content_hash.h"
#include "format/error.h"
#include "format/parallel.h"
#include "format/scene_xml.h"

namespace gigabake {
namespace {

/// Collects what is wrong with one cell.
class CellFaults {
 public:
  explicit CellFaults(std::filesystem::path file) : file_(std::move(file)) {}
  void expect(bool holds, const char* key, const char* message) {
    if (!holds) lines.push_back(InputError(file_, key, message).what());
  }
  std::vector<std::string> lines;

 private:
  std::filesystem::path file_;
};

std::vector<std::string> check_cell(const SceneDescription& scene, const SceneCell& cell,
                                    const std::filesystem::path& path) {
  CellFaults faults(path);
  const Shard shard = read_shard(path);
  const ShardHeader& h = shard.header;
  faults.expect(h.lattice_min == cell.lattice_min && h.cell_voxels == cell.cell_voxels, "lattice_min",
                "is another cell than scene.xml says");
  faults.expect(
      h.voxel_size_m == scene.voxel_size_m && h.lattice_origin_m == scene.lattice_origin_m && h.origin == scene.origin,
      "voxel_size_m", "stands on another lattice than the scene");
  faults.expect(h.fingerprint == cell.fingerprint, "fingerprint",
                "differs from scene.xml: the shard is of another bake");
  faults.expect(h.content_hash == cell.content_hash, "content_hash", "differs from scene.xml");
  faults.expect(h.has_normals == scene.has_normals, "channels", "differ from the scene's");
  faults.expect(std::filesystem::file_size(path) == cell.bytes, "", "has another size than scene.xml says");
  faults.expect(content_hash(shard) == h.content_hash, "content_hash", "the voxels are not those that were baked");
  return faults.lines;
}

/// Cells are windows of one lattice: no two may overlap.
void check_overlaps(const std::filesystem::path& xml, const SceneDescription& scene, VerifyResult& result) {
  std::set<std::array<std::int64_t, 3>> seen;
  for (const SceneCell& c : scene.cells)
    if (!seen.insert(c.lattice_min).second)
      result.faults.push_back(InputError(xml, c.name, "another cell has the same place").what());
}

}  // namespace

VerifyResult verify_scene(const std::filesystem::path& scene_xml, int threads) {
  const SceneDescription scene = read_scene(scene_xml);
  VerifyResult result;
  check_overlaps(scene_xml, scene, result);
  std::mutex mutex;
  parallel_ranges(scene.cells.size(), 1, threads, [&](std::size_t i, std::size_t) {
    const SceneCell& cell = scene.cells[i];
    std::vector<std::string> lines;
    try {
      lines = check_cell(scene, cell, scene_xml.parent_path() / cell.file);
    } catch (const std::exception& e) {
      lines = {e.what()};
    }
    const std::scoped_lock lock(mutex);
    ++result.cells;
    result.bytes += cell.bytes;
    result.voxels += std::accumulate(cell.voxels.begin(), cell.voxels.end(), std::uint64_t(0));
    result.faults.insert(result.faults.end(), lines.begin(), lines.end());
  });
  std::sort(result.faults.begin(), result.faults.end());
  return result;
}

}  // namespace gigabake
