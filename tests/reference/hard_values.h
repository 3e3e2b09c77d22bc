/// The named hard cases of what a voxel holds, and of what a bake drops and counts. Each is a check of its own.
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
