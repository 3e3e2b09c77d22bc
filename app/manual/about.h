/// The output of --version.
#pragma once

#include <string>

namespace gigabake::app {

/// Returns version and commit in the first line; then formats, compiler, CUDA and libraries, one per line. The last
/// line has no line end. Loads no library and does not query the GPU driver.
std::string about();

}  // namespace gigabake::app
