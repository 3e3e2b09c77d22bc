// Every mesh and tileset of the shared data is scanned and read, or refused with the reason that shared_data.txt in
// this folder lists. The output of the program is printed; a difference fails the test.
#include "tests/shared_data.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <iostream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "core/base/error.h"
#include "format/source/source.h"
#include "worker/scan/scan_tile.h"

namespace gigabake {
namespace {

using Path = std::filesystem::path;

constexpr const char* all_sets[] = {
    "3dtiles-validator-cases",      "cesium-3dtiles-samples", "cesium-native-tilesets", "cesiumjs-spec-tiles",
    "dem-derived-textured-terrain", "detail-models",          "gltf-compressed",        "gltf-sample-models",
    "gltf-validator-cases",         "mars-terrain-3dtiles",   "nasty-meshes",           "upaxis-tilesets"};

using test::shared_data;

/// Returns true for all files except those that other files refer to (buffers, images, subtrees, materials) and the
/// set's description.
bool is_mesh_or_tileset(const Path& file) {
  static const std::set<std::string> known{".gltf", ".glb", ".b3dm", ".i3dm",    ".cmpt", ".pnts", ".json",
                                           ".3tz",  ".obj", ".ply",  ".3dtiles", ".stl",  ".off",  ".dae",
                                           ".3ds",  ".lwo", ".ase",  ".md5mesh", ".smd",  ".x",    ".vctr"};
  return known.contains(file.extension().string()) && !file.filename().string().ends_with(".report.json");
}

/// Returns the reason without the parts that differ from file to file: its path, quoted text, numbers.
std::string kind_of(std::string reason) {
  static const std::regex path("^(tile )?[^ :]*/[^ :]*: "), quoted("'[^']*'"), where("\\[[0-9]+\\]"),
      number("\\b[0-9]+\\b(?!\\.[0-9])"), byte(" \\(at byte [^)]*\\)"), folder("/[^ ]*/data/[^ :]*");
  reason = std::regex_replace(reason, path, "");
  reason = std::regex_replace(reason, folder, "FILE");
  reason = std::regex_replace(reason, byte, "");
  reason = std::regex_replace(reason, quoted, "'…'");
  reason = std::regex_replace(reason, where, "[i]");
  return std::regex_replace(reason, number, "n");
}

struct SetOutcome {
  int files = 0, loaded = 0, partly = 0, refused = 0;
  std::uint64_t triangles = 0;
  std::map<std::string, int> reasons;
};

/// Reads a tile as a bake does. Returns the reason if it is missing, otherwise an empty string.
std::string try_tile(const SceneSources& sources, std::uint32_t tile, std::uint64_t& triangles) {
  static const ThreadPool pool(2);
  BakeParameters parameters;
  parameters.voxel_size_m = 1;
  const TileScan scan = scan_tile(sources, tile, parameters, pool);
  if (!scan.error.empty()) return scan.error;
  try {
    const TileMesh mesh = read_tile(sources.tiles[tile], sources.root, ReadScope::everything);
    for (const EncodedImage& image : mesh.images)
      if (!image.bytes.empty()) decode_image(image);
  } catch (const InputError& e) {
    return e.what();
  }
  triangles += scan.triangles;
  return "";
}

void try_source(const Path& file, SetOutcome& set) {
  ++set.files;
  SceneSources sources;
  try {
    sources = open_sources(file, {});
  } catch (const InputError& e) {
    ++set.refused;
    ++set.reasons[kind_of(e.what())];
    return;
  }
  std::size_t lost = 0, there = 0;
  for (const SkippedSource& s : sources.skipped) {
    ++set.reasons[(s.informative ? "(nothing lost) " : "") + kind_of(s.reason)];
    lost += s.informative ? 0 : 1;
  }
  for (std::uint32_t t = 0; t < sources.tiles.size(); ++t) {
    const std::string reason = try_tile(sources, t, set.triangles);
    (reason.empty() ? there : lost) += 1;
    if (!reason.empty()) ++set.reasons[kind_of(reason)];
  }
  ++(lost == 0 ? set.loaded : there != 0 ? set.partly : set.refused);
}

SetOutcome try_set(const Path& folder) {
  std::set<Path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && is_mesh_or_tileset(entry.path())) files.insert(entry.path());
  SetOutcome set;
  for (const Path& file : files) try_source(file, set);
  return set;
}

std::string table_of(const std::string& name, const SetOutcome& set) {
  std::ostringstream text;
  text << name << ": " << set.files << " files, " << set.loaded << " loaded, " << set.partly << " partly, "
       << set.refused << " refused, " << set.triangles << " triangles\n";
  for (const auto& [reason, count] : set.reasons) text << "  " << count << " × " << reason << '\n';
  return text.str();
}

/// Returns the set's paragraph: its line and the indented lines below it.
std::string written_down(const std::string& name) {
  std::ifstream in(Path(GIGABAKE_SOURCE_DIR) / "tests/worker/shared_data.txt");
  std::string out;
  bool here = false;
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("  ")) here = line.starts_with(name + ": ");
    if (here) out += line + '\n';
  }
  return out;
}

class SharedData : public testing::TestWithParam<const char*> {};

TEST_P(SharedData, LoadsOrIsRefusedForTheReasonsWrittenDown) {
  const Path folder = shared_data() / GetParam();
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is absent";
  const std::string table = table_of(GetParam(), try_set(folder));
  std::cout << table;
  // Skips only if CMake found a library missing. A reader that merely reports a missing library must not skip the test.
  if (!GIGABAKE_READS_EVERYTHING && table.find("this gigabake was built without") != std::string::npos)
    GTEST_SKIP() << "not compared: a library is missing, see the table";
  EXPECT_TRUE(table == written_down(GetParam())) << "tests/worker/shared_data.txt says\n" << written_down(GetParam());
}

INSTANTIATE_TEST_SUITE_P(Sets, SharedData, testing::ValuesIn(all_sets), [](const auto& set) {
  std::string name = set.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return "set_" + name;
});

}  // namespace
}  // namespace gigabake
