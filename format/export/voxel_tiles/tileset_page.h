/// The web page in a tileset's folder that displays the tileset.
#pragma once

namespace gigabake {

/// index.html: CesiumJS renders the tileset.json next to it, interpolated, with the whole scene in view.
extern const char* const tileset_page;

}  // namespace gigabake
