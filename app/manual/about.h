/// The output of --version.
#pragma once

#include <string>

namespace gigabake::app {

/// Returns version and commit, such as "0.3.0, commit 0123456789ab".
std::string build_version();

/// Returns build_version() in the first line; then formats, compiler, CUDA and libraries, one per line. The last
/// line has no line end. Loads no library and does not query the GPU driver.
std::string about();

}  // namespace gigabake::app
