/// Texts that name a coordinate system, before GDAL sees them: it also takes names of files and addresses.
#pragma once

#include <string>

namespace gigabake {

/// Is it a code ("EPSG:25832", "OGC:CRS84", "EPSG:25832+5783"), a WKT, a PROJJSON, or a PROJ text ("+proj=utm …")
/// all of whose parameters are known to be numbers and names: none that leads to a file, no pipeline?
/// A WKT may hold a PROJ text, which is looked at too, and no parameter file.
bool is_plain_crs(const std::string& text);

}  // namespace gigabake
