/// Verification of a scene: every checksum, reference and invariant of its shards, and the data that it lacks.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "format/scene/xml/scene_xml.h"

namespace gigabake {

/// Counts of the losses that a scene records. An overview is a shard of the levels above the cells. Overviews are
/// counted only if no cell is missing, because the overviews above a missing cell are always incomplete.
struct MissingData {
  std::uint64_t cells = 0, overviews = 0, inputs = 0;
  std::uint64_t planned_cells = 0;  ///< cells of the scene plus missing cells

  bool any() const { return cells + overviews + inputs != 0; }
};

/// Counts the losses. `cells` is the number of cells that the scene has.
MissingData missing_data(const SceneHeader& scene, std::uint64_t cells);

/// Returns a text such as "9 of 16 cells are missing", or "1 of 4 cells, 1 overview and 2 inputs are missing".
/// Range   missing.any() is true.
std::string describe(const MissingData& missing);

struct VerifyResult {
  std::uint64_t cells = 0, voxels = 0, bytes = 0;  ///< as listed in scene.xml and its pages
  bool has_totals = true;           ///< whether scene.xml stores the number of cells; if not, a lost cell is not
                                    ///< detected
  MissingData missing;              ///< as stored in scene.xml
  std::vector<std::string> faults;  ///< one line each: file, dataset, fault; in the scene's order
};

/// A function that returns the faults of an overview compared with its children, one line each. It must be thread-safe.
/// `children` are the cells or overviews directly below the overview that its window overlaps.
using OverviewCheck = std::function<std::vector<std::string>(const SceneHeader& scene, const SceneCell& overview,
                                                             std::span<const SceneCell> children)>;

/// Reads every shard completely and compares it with scene.xml, including the hashes of its voxels.
/// Cost    Reads all shards once; holds one cell in memory per thread.
/// Errors  InputError if scene.xml itself cannot be read; faults of shards are returned. Stopped if `progress` cancels.
VerifyResult verify_scene(const std::filesystem::path& scene_xml, int threads, const Progress& progress = {},
                          const OverviewCheck& check_overview = {});

}  // namespace gigabake
