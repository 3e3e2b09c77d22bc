/// Manual pages in the man macros of troff.
#pragma once

#include <string>

#include "app/command_tree.h"

namespace gigabake::app {

/// gigabake-bench-render.1
std::string man_file(const Command& command);
/// UTF-8. `root` is the whole program: its commands are referred to.
std::string man_page(const Command& command, const Command& root);

}  // namespace gigabake::app
