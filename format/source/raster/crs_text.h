/// Validation of texts that name a coordinate system, before they reach GDAL, which also accepts files and URLs.
#pragma once

#include <string>

namespace gigabake {

/// Returns whether a text names a coordinate system without reference to files.
/// Accepts codes ("EPSG:25832", "OGC:CRS84", "EPSG:25832+5783"), WKT, PROJJSON and PROJ texts ("+proj=utm …"). All
/// parameters of a PROJ text must be known to be numbers or names; pipelines are not accepted. WKT and
/// PROJJSON must not have a parameter file; PROJ texts inside them are checked, too. Geoid grids in WKT
/// must have names without folders.
bool is_plain_crs(const std::string& text);

}  // namespace gigabake
