#include "bench/query/cube_caster.h"
#include "core/base/error.h"

namespace gigabake::bench {

struct CubeCaster::State {};

CubeCaster::CubeCaster(const std::vector<Vec3i64>&, int) {
  throw UsageError("bench query: this gigabake was built without Embree; install libembree-dev and build again");
}
CubeCaster::~CubeCaster() = default;
std::optional<CubeCaster::Hit> CubeCaster::first_hit(const Vec3d&, const Vec3d&) const {
  return {};  // never called: no caster can be constructed
}

}  // namespace gigabake::bench
