/// Restriction of the files that PROJ may open. The text of a coordinate system comes from an untrusted file, and may
/// name files by any path or URL: `+nadgrids=/etc/passwd`, `+nadgrids=http://…`, or a parameter file of a WKT.
#pragma once

namespace gigabake {

/// Restricts all contexts of PROJ in this process, including GDAL's, to reading files in the folders of PROJ.
/// These folders hold proj.db and installed grids. Writing and network access are disabled. Must be called before GDAL
/// creates a context.
void confine_proj();

}  // namespace gigabake
