// Writes the scene.xml and the pages of a large generated scene, without the shards of its cells. It serves programs
// that read only the scene, such as `gigabake info`. The option --shards adds the overview shards that distant views
// read. The scene is an undulating surface of cells; the counts and hashes of a cell are derived from its number.
#include <CLI/CLI.hpp>
#include <array>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <vector>

#include "bench/pages/painted_overview.h"
#include "core/octree/parameters.h"
#include "format/scene/paged_scene.h"
#include "format/shard/levels/brick_walk.h"
#include "format/system/host_limits.h"
#include "scheduler/plan/overviews.h"

namespace gigabake {
namespace {

constexpr std::uint32_t edge = 1024, lods = 8;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Returns the height of the surface.
/// Space   Lod-0 voxels.
double surface_height(double x, double y) { return edge * (3 * std::sin(x / edge / 40) + 3 * std::sin(y / edge / 30)); }

SceneCell made_cell(std::int64_t x, std::int64_t y) {
  const auto z = std::int64_t(std::floor(surface_height((double(x) + .5) * edge, (double(y) + .5) * edge) / edge));
  const std::uint64_t number = std::uint64_t(x) << 32 | std::uint64_t(y);
  SceneCell cell;
  cell.name = fmt::format("c_{}_{}_{}", x, y, z);
  cell.fingerprint = {number * 0x9e3779b97f4a7c15u, number ^ 0x0123456789abcdefu};
  cell.file = fmt::format("shards/{}-{}.h5", cell.name, cell.fingerprint.hex());
  cell.lattice_min = {x * edge, y * edge, z * edge};
  cell.cell_voxels = edge;
  cell.lods = lods;
  cell.triangles = 2000 + number % 1000;
  for (std::uint32_t lod = 0; lod < lods; ++lod) {
    cell.voxels.push_back((std::uint64_t(edge) * edge >> 2 * lod) + number % 777);
    cell.level_bytes.push_back(cell.voxels.back() * 2);
    cell.content_hash.push_back({number * (2 * lod + 3), number * (2 * lod + 5)});
    cell.bytes += cell.level_bytes.back();
  }
  cell.node_bytes = cell.bytes / 20;
  cell.bytes += cell.node_bytes + 30000;
  return cell;
}

/// Returns the scene's entry of an overview that has no shard. Voxels are counted as if the surface were flat; sizes in
/// bytes and content hashes are invented.
SceneCell made_overview(const CellJob& job) {
  SceneCell overview = cell_of(job);
  for (std::uint32_t width = job.cell_voxels >> job.first_lod; width >= 8; width /= 2) {
    overview.voxels.push_back(std::uint64_t(width) * width);
    overview.level_bytes.push_back(4 * overview.voxels.back());
    overview.content_hash.push_back(job.fingerprint);
    overview.bytes += overview.level_bytes.back();
  }
  overview.lods = std::uint32_t(overview.voxels.size());
  overview.node_bytes = 300;
  overview.bytes += 40000;
  return overview;
}

SceneCell written_overview(const std::filesystem::path& out, const CellJob& job, double voxel_size_m) {
  const Shard shard = painted_overview(job, surface_height, voxel_size_m);
  SceneCell overview = cell_of(job);
  const StoredShard stored = write_shard(out / overview.file, shard, {});
  overview.lods = shard.header.lods;
  overview.bytes = stored.file;
  overview.voxels = count_voxels(shard);
  overview.content_hash = shard.header.content_hash;
  overview.level_bytes = stored.levels;
  overview.node_bytes = stored.nodes;
  return overview;
}

/// Returns the overviews of all cells. If `shards` is true, also writes the shards of overviews whose children are
/// overviews. A view of the whole scene reads no other shards.
std::vector<SceneCell> made_overviews(const std::filesystem::path& out, const std::vector<SceneCell>& cells,
                                      bool shards, double voxel_size_m) {
  std::vector<CellJob> jobs;
  for (const SceneCell& cell : cells) jobs.push_back(job_of(cell));
  add_overviews(jobs);
  std::vector<SceneCell> overviews(jobs.size() - cells.size());
  ThreadPool(host_limits().cores()).parallel_for(overviews.size(), 1, [&](std::size_t i, std::size_t, int) {
    const CellJob& job = jobs[cells.size() + i];
    const bool is_above_overviews = job.children.front() >= cells.size();
    overviews[i] = shards && is_above_overviews ? written_overview(out, job, voxel_size_m) : made_overview(job);
  });
  return overviews;
}

void write(const std::filesystem::path& out, std::uint64_t cells, bool shards) {
  BakeParameters parameters;
  parameters.voxel_size_m = 0.1;
  parameters.cell_voxels = edge;
  SceneDescription scene;
  scene.generator = "gigabake made_scene";
  scene.voxel_size_m = parameters.voxel_size_m;
  scene.parameters = to_json(parameters);
  scene.has_directional_coverage = has_directional_coverage(parameters);
  const auto along = std::uint64_t(std::ceil(std::sqrt(double(cells))));
  for (std::uint64_t i = 0; i < cells; ++i)
    scene.cells.push_back(made_cell(std::int64_t(i % along), std::int64_t(i / along)));
  std::sort(scene.cells.begin(), scene.cells.end(), is_before);
  for (const SceneCell& cell : scene.cells) scene.triangles += cell.triangles;
  std::filesystem::create_directories(out / "shards");
  scene.overviews = made_overviews(out, scene.cells, shards, parameters.voxel_size_m);
  const auto start = std::chrono::steady_clock::now();
  write_scene(out / "scene.xml", scene);
  fmt::print("{} cells and {} overviews written in {:.2f} s\n", cells, scene.overviews.size(), seconds_since(start));
}

}  // namespace
}  // namespace gigabake

int main(int argc, char** argv) {
  CLI::App app("Writes a scene of many cells without their shards");
  bool shards = false;
  app.add_flag("--shards", shards, "also write the shards of overviews of overviews: some GB for 10^6 cells");
  std::string out;
  std::uint64_t cells = 1000000;
  app.add_option("OUT", out, "folder to write to")->required();
  app.add_option("--cells", cells, "number of cells")->check(CLI::Range(std::uint64_t(1), std::uint64_t(1) << 28));
  CLI11_PARSE(app, argc, argv);
  try {
    gigabake::write(out, cells, shards);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
