/// A hard case: a scene, the window of voxels that is compared, the expected voxels, and the error bounds.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bench/hard/hard_bench.h"
#include "bench/hard/hard_scene.h"
#include "core/octree/parameters.h"
#include "format/job/cell_job.h"

namespace gigabake::bench {

/// The error bounds of a case; nullopt: not measured.
struct HardBounds {
  double alpha_codes = 0.501;                 ///< alpha, max error in codes of 255
  std::optional<double> colour_codes = 0.65;  ///< opaque colours, max error in sRGB codes: rounding, 16 bits
  std::optional<double> colour_linear = {};   ///< linear colours of a texture, max error; 1 is white
  std::optional<double> normal_deg = 1.01;    ///< max angle: rounding to two octahedral bytes and 16 bits
  double placement_m = 0;                     ///< max error of a vertex in double, before the snap
};

struct StoredVoxel {
  std::array<std::uint8_t, 4> rgba{};
  std::array<std::int8_t, 2> normal{};
  std::uint8_t plane = 0;  ///< core/octree/plane.h
  VoxelClass voxel_class = no_class;
};
using StoredVoxels = std::map<reference::Voxel, StoredVoxel>;
using ExpectedVoxels = std::map<reference::Voxel, reference::ExpectedVoxel>;

/// The result of baking a scene as one cell.
struct HardBake {
  CellReport report;
  StoredVoxels voxels;               ///< of level 0
  std::vector<StoredVoxels> leaves;  ///< [lod - 1], in voxels of their level
  std::string content_hash;
  double placement_m = 0;  ///< maximum distance of a vertex in double from its exact position, before the snap
  double position_m = 0;   ///< the same distance after the snap
};

struct HardCase {
  std::string name, group, what;
  /// Several scenes are encodings of the same surface; the bakes must be bit-identical.
  std::vector<HardScene> scenes{};
  BakeParameters parameters{};
  reference::Window window{};
  HardBounds bounds{};
  /// The occupied voxels, derived by hand. If nullopt, voxels are compared only with the reference.
  std::optional<std::set<reference::Voxel>> by_hand{};
  /// Returns the expected voxels if exact clipping of plain triangles cannot be the reference: for textures, and for
  /// too many triangles.
  std::function<ExpectedVoxels()> expected{};
  /// Returns the expected voxels of level 0 and the leaves of coarser levels, for tiles of several levels.
  std::function<std::vector<ExpectedVoxels>()> expected_levels{};
  /// Returns additional measurements of the case's first scene.
  std::function<std::vector<HardFigure>(const HardBake&)> more{};
};

struct HardMachine {
  std::optional<int> cuda_device;
  int threads = 1;
};

/// Runs a case and replaces `folder`. Never throws for a failure of the case: HardResult::error holds the message.
HardResult run_hard_case(const HardCase& hard, const std::filesystem::path& folder, const HardMachine& machine);

/// The length of a sub-voxel in a lattice case: voxels are 0.25 m, and the window is [-8, 8)³.
inline constexpr double lattice_unit_m = 1.0 / 1024;
HardCase lattice_case(std::string name, std::string group, std::string what);

std::vector<HardCase> tie_cases();    ///< occupancy on ties, three rules, derived by hand
std::vector<HardCase> value_cases();  ///< colour, alpha and normal
std::vector<HardCase> extreme_cases(int million_triangles);
std::vector<HardCase> earth_cases();    ///< tiles in ECEF, and 1,000 km from the origin
std::vector<HardCase> texture_cases();  ///< texture coordinates, seams, masks
std::vector<HardCase> leaf_cases();     ///< voxels of several levels, and planes of leaves
std::vector<HardCase> class_cases();    ///< classes of equal areas

}  // namespace gigabake::bench
