/// What --version says.
#pragma once

#include <string>

namespace gigabake::app {

/// The first line has version and commit; then formats, compiler, CUDA and libraries, a line each, without a last end
/// of line. Loads nothing and asks no driver.
std::string about();

}  // namespace gigabake::app
