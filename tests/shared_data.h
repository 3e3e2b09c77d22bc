/// Real terrain and models that stand beside the checkout, or elsewhere; tests skip where they are absent.
#pragma once

#include <cstdlib>
#include <filesystem>

namespace gigabake::test {

inline std::filesystem::path shared_data() {
  if (const char* path = std::getenv("GIGABAKE_SHARED")) return std::filesystem::path(path) / "data";
  return std::filesystem::path(GIGABAKE_SOURCE_DIR) / "../shared/data";
}

}  // namespace gigabake::test
