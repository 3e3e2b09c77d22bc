/// What PROJ may open. A coordinate system is text of a file that nobody vouches for, and such text may name grids and
/// definitions by any path or address: `+nadgrids=/etc/passwd`, `+nadgrids=http://…`, a parameter file of a WKT.
#pragma once

namespace gigabake {

/// From now on every context of PROJ in this process, GDAL's too, reads files of PROJ's own folders (proj.db, installed
/// grids) and nothing else, writes nothing and reaches no network. To be called before GDAL makes a context.
void confine_proj();

}  // namespace gigabake
