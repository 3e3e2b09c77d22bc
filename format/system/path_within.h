/// Test whether a path lies in a folder.
#pragma once

#include <algorithm>
#include <filesystem>

namespace gigabake {

/// Returns whether `path` is `folder` or lies below it. Compares names only.
/// Range   Both paths are canonical.
inline bool is_within(const std::filesystem::path& folder, const std::filesystem::path& path) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

}  // namespace gigabake
