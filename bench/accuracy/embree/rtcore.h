/// A wrapper of the calls that differ between Embree 3 and 4.
#pragma once

#if GIGABAKE_EMBREE == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace gigabake::bench {

inline void intersect(RTCScene scene, RTCRayHit& hit) {
#if GIGABAKE_EMBREE == 4
  rtcIntersect1(scene, &hit, nullptr);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &hit);
#endif
}

}  // namespace gigabake::bench
