/// Real terrain and models, stored next to the checkout or elsewhere. Tests that need them skip if they are absent.
#pragma once

#include <cstdlib>
#include <filesystem>

namespace gigabake::test {

inline std::filesystem::path shared_data() {
  if (const char* path = std::getenv("GIGABAKE_SHARED")) return std::filesystem::path(path) / "data";
  return std::filesystem::path(GIGABAKE_SOURCE_DIR) / "../shared/data";
}

}  // namespace gigabake::test
