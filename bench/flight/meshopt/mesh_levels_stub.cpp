#include "bench/flight/mesh_levels.h"
#include "core/base/error.h"

namespace gigabake::bench {

bool has_mesh_levels() { return false; }

MeshLevels make_mesh_levels(const SourceTriangles&, std::size_t) {
  throw UsageError("--flight: built without meshoptimizer");
}

}  // namespace gigabake::bench
