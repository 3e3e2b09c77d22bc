/// Where something is published, and what is said when that fails.
#pragma once

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>

#include "lattice/error.h"

namespace gigabake {

/// Throws InputError "cannot WHAT: the system's reason", which it takes from errno.
[[noreturn]] inline void fail_to(const std::filesystem::path& path, const char* what) {
  throw InputError(path, "", std::string("cannot ") + what + ": " + std::strerror(errno));
}

/// The folder that holds `path`.
inline std::filesystem::path folder_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

}  // namespace gigabake
