/// The page of a tileset's folder that shows it.
#pragma once

namespace gigabake {

/// index.html: CesiumJS draws tileset.json beside it, interpolated, the whole scene in view.
extern const char* const tileset_page;

}  // namespace gigabake
