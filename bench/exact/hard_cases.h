/// The named hard cases: triangles chosen to sit on a tie, with the voxels each rule must give them, worked out by
/// hand. docs/accuracy-hard-cases.md lists every name with its reason.
#pragma once

#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "bench/exact/exact_clip.h"

namespace gigabake::reference {

/// Every case is seen through this window: two bricks to each side of the origin's three planes.
inline constexpr std::int64_t hard_case_low = -8, hard_case_high = 8;

struct HardCase {
  std::string name;
  std::vector<Triangle> triangles;  ///< sub-voxels
  std::set<Voxel> area, conservative, thin;
};

inline std::ostream& operator<<(std::ostream& out, const HardCase& c) { return out << c.name; }

/// About single voxels, and about planes and slivers across many.
std::vector<HardCase> small_hard_cases();
std::vector<HardCase> wide_hard_cases();

inline const std::set<Voxel> none;

/// Voxels low … high, both included.
std::set<Voxel> cells(const Voxel& low, const Voxel& high);
std::set<Voxel> operator+(std::set<Voxel> a, const std::set<Voxel>& b);

}  // namespace gigabake::reference
