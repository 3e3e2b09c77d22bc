/// Manual pages on a terminal.
#pragma once

#include <string>

namespace gigabake::app {

/// On a terminal the page as man (else groff with $PAGER, else less) shows it; where none of these is installed, and
/// where standard output is no terminal, the page itself.
void show_man_page(const std::string& page);

}  // namespace gigabake::app
