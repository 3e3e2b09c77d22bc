/// One hard case: a scene, the cell through which it is seen, what must come out, and what is claimed of the errors.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bench/hard/hard_bench.h"
#include "bench/hard/hard_scene.h"
#include "format/job/cell_job.h"
#include "lattice/parameters.h"

namespace gigabake::bench {

/// Largest errors that are claimed; nothing: not looked at.
struct HardBounds {
  double alpha_codes = 0.501;                 ///< of 255
  std::optional<double> colour_codes = 0.65;  ///< sRGB, opaque: rounding, and what 16 bits lose
  std::optional<double> colour_linear = {};   ///< of a texture, 0 … 1
  std::optional<double> normal_deg = 1.01;    ///< two octahedral bytes, and 16 bits
  double placement_m = 0;                     ///< of a vertex in double, before the snap
};

struct StoredVoxel {
  std::array<std::uint8_t, 4> rgba{};
  std::array<std::int8_t, 2> normal{};
};
using StoredVoxels = std::map<reference::Voxel, StoredVoxel>;
using ExpectedVoxels = std::map<reference::Voxel, reference::ExpectedVoxel>;

/// A scene baked as one cell.
struct HardBake {
  CellReport report;
  StoredVoxels voxels;
  std::string content_hash;
  double placement_m = 0;  ///< largest distance of a vertex in double from where it is
  double position_m = 0;   ///< the same after the snap
};

struct HardCase {
  std::string name, group, what;
  /// Several: the same surface written in other ways, of which no bit may show.
  std::vector<HardScene> scenes{};
  BakeParameters parameters{};
  reference::Window window{};
  HardBounds bounds{};
  /// Worked out by hand; nothing: by the reference alone.
  std::optional<std::set<reference::Voxel>> by_hand{};
  /// Where the exact pieces of plain triangles are not the reference: textures, counts beyond clipping.
  std::function<ExpectedVoxels()> expected{};
  /// What this case measures besides, of its first scene.
  std::function<std::vector<HardFigure>(const HardBake&)> more{};
};

struct HardMachine {
  std::optional<int> cuda_device;
  int threads = 1;
};

/// Replaces `folder`. Errors  None thrown for what goes wrong with the case: HardResult::error.
HardResult run_hard_case(const HardCase& hard, const std::filesystem::path& folder, const HardMachine& machine);

/// A case of the lattice: 0.25 m voxels, so that a sub-voxel is 2^-10 m, seen through [-8, 8)³.
inline constexpr double lattice_unit_m = 1.0 / 1024;
HardCase lattice_case(std::string name, std::string group, std::string what);

std::vector<HardCase> tie_cases();    ///< occupancy on ties, three rules, worked out by hand
std::vector<HardCase> value_cases();  ///< colour, alpha and normal
std::vector<HardCase> extreme_cases(int million_triangles);
std::vector<HardCase> earth_cases();    ///< tiles in ECEF, and a thousand kilometres away
std::vector<HardCase> texture_cases();  ///< texture coordinates, seams, masks

}  // namespace gigabake::bench
