/// The web page in a tileset's folder that displays the tileset.
#pragma once

namespace gigabake {

/// The content of index.html. CesiumJS renders the tileset.json of the same folder with interpolation, and the whole
/// scene is in view.
extern const char* const tileset_page;

}  // namespace gigabake
