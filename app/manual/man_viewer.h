/// Manual pages on a terminal.
#pragma once

#include <string>

namespace gigabake::app {

/// Shows the page on a terminal with man, or else with groff and $PAGER (default less). Prints the page's source if
/// neither is installed or standard output is not a terminal.
void show_man_page(const std::string& page);

}  // namespace gigabake::app
