/// Restriction of the files that PROJ may open. The text of a coordinate system comes from an untrusted file, and may
/// name files by any path or URL: `+nadgrids=/etc/passwd`, `+nadgrids=http://…`, or a parameter file of a WKT.
#pragma once

#include <proj.h>

namespace gigabake {

/// Disables network access of all contexts of PROJ in this process, including GDAL's. Restricts the default context to
/// reading files in the folders of PROJ. Must be called before GDAL creates a context.
/// A context of GDAL does not copy this restriction: is_plain_crs() must accept a text before it reaches GDAL.
void confine_proj();

/// Restricts a context to reading files in the folders of PROJ, which hold proj.db and installed grids.
void confine_files(PJ_CONTEXT* context);

}  // namespace gigabake
