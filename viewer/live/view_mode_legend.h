/// What the colours of a view mode mean.
#pragma once

#include <string>

#include "viewer/pictures/frame_renderer.h"

namespace gigabake {

/// One line: what is shown, and its colours. The page in the browser, the window, --help and docs/viewer.md say it.
std::string view_mode_legend(ViewMode mode);

}  // namespace gigabake
