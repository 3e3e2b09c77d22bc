// Writes the scene.xml and the pages of a large scene without its shards: for what looks at the scene alone, as info
// does. A rolling surface of cells, each with counts and hashes that follow from its number.
#include <CLI/CLI.hpp>
#include <array>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <optional>
#include <vector>

#include "format/scene/paged_scene.h"
#include "lattice/parameters.h"

namespace gigabake {
namespace {

constexpr std::uint32_t edge = 1024, lods = 8;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

SceneCell made_cell(std::int64_t x, std::int64_t y) {
  const auto z = std::int64_t(std::lround(3 * std::sin(double(x) / 40) + 3 * std::sin(double(y) / 30)));
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

/// Where a window of this edge holds the box and begins at a multiple of half of it.
std::optional<std::array<std::int64_t, 3>> root_window(const LatticeBox& box, std::int64_t root_edge) {
  std::array<std::int64_t, 3> min;
  for (std::size_t a = 0; a < 3; ++a) {
    min[a] = box.min[a] & -(root_edge / 2);
    if (box.end[a] > min[a] + root_edge) return {};
  }
  return min;
}

SceneCell parent_at(const std::array<std::int64_t, 3>& at, std::uint32_t first_lod, std::uint32_t levels,
                    std::uint32_t parent_edge) {
  SceneCell parent;
  parent.first_lod = first_lod;
  parent.lods = levels;
  parent.cell_voxels = parent_edge;
  parent.lattice_min = at;
  for (std::uint32_t lod = 0; lod < levels; ++lod) {
    parent.voxels.push_back(1024u >> 2 * lod);
    parent.level_bytes.push_back(4 * parent.voxels.back());
  }
  parent.node_bytes = 300;
  parent.bytes = 40000;
  return parent;
}

/// One of three levels above each block of 8³ of `below`, or a root of as many as it takes.
std::vector<SceneCell> made_parents(const std::vector<SceneCell>& below) {
  const SceneCell& first = below.at(0);
  const std::uint32_t first_lod = first.first_lod + first.lods;
  LatticeBox box;
  for (const SceneCell& child : below) box = hull(box, window_of(child));
  std::map<std::array<std::int64_t, 3>, SceneCell> parents;
  std::optional<std::array<std::int64_t, 3>> root;
  std::uint32_t levels = 0;
  while (!root && levels < 3) root = root_window(box, std::int64_t(first.cell_voxels) << ++levels);
  const std::uint32_t block = first.cell_voxels << levels;
  for (const SceneCell& child : below) {
    std::array<std::int64_t, 3> at = child.lattice_min;
    for (std::int64_t& v : at) v &= -std::int64_t(block);
    if (root) at = *root;
    SceneCell& parent = parents.try_emplace(at, parent_at(at, first_lod, levels, block)).first->second;
    parent.content_hash.assign(levels, child.fingerprint);
    parent.fingerprint += child.fingerprint;
    parent.triangles += child.triangles;
  }
  std::vector<SceneCell> made;
  for (auto& [at, parent] : parents) {
    parent.name = fmt::format("p{}_{}_{}_{}", first_lod, at[0] / block, at[1] / block, at[2] / block);
    parent.file = fmt::format("shards/{}-{}.h5", parent.name, parent.fingerprint.hex());
    made.push_back(std::move(parent));
  }
  return made;
}

void write(const std::filesystem::path& out, std::uint64_t cells) {
  BakeParameters parameters;
  parameters.voxel_size_m = 0.1;
  parameters.cell_voxels = edge;
  SceneDescription scene;
  scene.generator = "gigabake made_scene";
  scene.voxel_size_m = parameters.voxel_size_m;
  scene.parameters = to_json(parameters);
  scene.has_facing = has_facing(parameters);
  const auto along = std::uint64_t(std::ceil(std::sqrt(double(cells))));
  for (std::uint64_t i = 0; i < cells; ++i)
    scene.cells.push_back(made_cell(std::int64_t(i % along), std::int64_t(i / along)));
  std::sort(scene.cells.begin(), scene.cells.end(), is_before);
  for (const SceneCell& cell : scene.cells) scene.triangles += cell.triangles;
  for (std::vector<SceneCell> level = scene.cells; level.size() > 1;) {
    level = made_parents(level);
    scene.parents.insert(scene.parents.end(), level.begin(), level.end());
  }
  std::filesystem::create_directories(out);
  const auto start = std::chrono::steady_clock::now();
  write_scene(out / "scene.xml", scene);
  fmt::print("{} cells and {} parents written in {:.2f} s\n", cells, scene.parents.size(), seconds_since(start));
}

}  // namespace
}  // namespace gigabake

int main(int argc, char** argv) {
  CLI::App app("Writes a scene of many cells without their shards");
  std::string out;
  std::uint64_t cells = 1000000;
  app.add_option("OUT", out, "folder to write to")->required();
  app.add_option("--cells", cells, "how many")->check(CLI::Range(std::uint64_t(1), std::uint64_t(1) << 28));
  CLI11_PARSE(app, argc, argv);
  try {
    gigabake::write(out, cells);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
