/// Manual pages in the man macros of troff.
#pragma once

#include <string>

#include "app/command_tree.h"

namespace gigabake::app {

/// Returns the file name, such as gigabake-bench-render.1.
std::string man_file(const Command& command);
/// Returns the page in UTF-8. `root` is the whole program, to whose commands the page refers.
std::string man_page(const Command& command, const Command& root);

}  // namespace gigabake::app
