#include "bench/accuracy/reference_caster.h"
#include "core/base/error.h"

namespace gigabake::bench {

struct ReferenceCaster::State {};

bool ReferenceCaster::is_built() { return false; }

ReferenceCaster::ReferenceCaster(const SceneSources&, const BakeParameters&, int) {
  throw UsageError("bench accuracy: this gigabake was built without Embree; install libembree-dev and build again");
}

ReferenceCaster::ReferenceCaster(SourceTriangles, int) {
  throw UsageError("bench accuracy: this gigabake was built without Embree");
}

ReferenceCaster::~ReferenceCaster() = default;

// Without Embree no caster can be constructed, so none of these functions is called.
const TriangleBox& ReferenceCaster::box() const { throw UsageError("bench accuracy: built without Embree"); }
const SourceTriangles& ReferenceCaster::triangles() const { throw UsageError("bench accuracy: built without Embree"); }
std::vector<TriangleName> ReferenceCaster::near(const Vec3d&, double) const { return {}; }
LinearPicture ReferenceCaster::draw(const kernels::CastCamera&, int, const kernels::CastLight&) const { return {}; }
LinearPicture ReferenceCaster::draw_shadowed(const kernels::CastCamera&, int, const kernels::CastLight&, double) const {
  return {};
}
std::optional<double> ReferenceCaster::first_hit(const Vec3d&, const Vec3d&) const { return {}; }

}  // namespace gigabake::bench
