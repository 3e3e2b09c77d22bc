/// The hard cases for the values of a voxel, and for triangles that a bake drops and counts. Each case is a check.
#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <vector>

namespace gigabake::reference {

struct HardValue {
  std::string name;
  std::function<void()> check;  ///< GoogleTest expectations
};

inline std::ostream& operator<<(std::ostream& out, const HardValue& v) { return out << v.name; }

std::vector<HardValue> hard_colours();
std::vector<HardValue> hard_normals();
std::vector<HardValue> hard_inputs();

}  // namespace gigabake::reference
