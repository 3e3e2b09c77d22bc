/// The named hard cases: triangles that lie on a tie, with the voxels that each rule must produce, derived by hand.
/// docs/accuracy-hard-cases.md lists every name with its reason.
#pragma once

#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "bench/exact/exact_clip.h"

namespace gigabake::reference {

/// The window of every case in voxels: one brick on each side of the origin, per axis.
inline constexpr std::int64_t hard_case_low = -8, hard_case_high = 8;

struct HardCase {
  std::string name;
  std::vector<Triangle> triangles;  ///< sub-voxels
  std::set<Voxel> area, conservative, thin;
};

inline std::ostream& operator<<(std::ostream& out, const HardCase& c) { return out << c.name; }

/// Returns the cases of single voxels; wide_hard_cases() returns planes and slivers across many voxels.
std::vector<HardCase> small_hard_cases();
std::vector<HardCase> wide_hard_cases();

inline const std::set<Voxel> none;

/// Returns the voxels low … high, both included.
std::set<Voxel> cells(const Voxel& low, const Voxel& high);
std::set<Voxel> operator+(std::set<Voxel> a, const std::set<Voxel>& b);

}  // namespace gigabake::reference
