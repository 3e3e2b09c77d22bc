/// The legend of a view mode's colours.
#pragma once

#include <string>

#include "viewer/pictures/frame_renderer.h"

namespace gigabake {

/// Returns one line: the quantity that the mode shows, and its colours. The web page, the window, --help and
/// docs/viewer.md contain this line.
std::string view_mode_legend(ViewMode mode);

}  // namespace gigabake
