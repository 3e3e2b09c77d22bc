/// Text that names a failing random case, complete enough to add it as a hard case.
#pragma once

#include <sstream>
#include <string>

#include "bench/exact/exact_clip.h"
#include "core/base/rules.h"

namespace gigabake::reference {

inline const char* name_of(SurfaceRule rule) {
  return rule == SurfaceRule::area ? "area" : rule == SurfaceRule::thin ? "thin" : "conservative";
}

inline std::string text_of(const Triangle& t) {
  std::ostringstream out;
  for (const auto& v : t) out << '(' << v[0] << ", " << v[1] << ", " << v[2] << ") ";
  return out.str();
}

inline std::string describe(std::uint64_t seed, int number, const Triangle& t, SurfaceRule rule) {
  return ", " + std::string(name_of(rule)) + ", seed " + std::to_string(seed) + ", case " + std::to_string(number) +
         ", sub-voxels " + text_of(t);
}

}  // namespace gigabake::reference
