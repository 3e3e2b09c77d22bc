/// Numbers of one group of lanes. Operators apply to each lane and give the bits of the scalar operator.
///
/// Compilers vectorize the scalar loop over lanes with more instructions: they turn each clamp into six comparisons and
/// selections, and use half of a register where doubles and floats are mixed.
#pragma once

#include <cstdint>

namespace gigabake::kernels {

/// Number of lanes: as many doubles as a vector register of the target holds.
#if defined(__AVX__)
inline constexpr int lane_group = 4;
#else
inline constexpr int lane_group = 2;
#endif

using DoubleVector = double __attribute__((vector_size(8 * lane_group)));
using FloatVector = float __attribute__((vector_size(4 * lane_group)));

/// True or false per lane.
struct LaneMask {
  std::int64_t __attribute__((vector_size(8 * lane_group))) v;

  friend LaneMask operator&(LaneMask a, LaneMask b) { return {a.v & b.v}; }
  friend LaneMask operator|(LaneMask a, LaneMask b) { return {a.v | b.v}; }
};

struct FloatLanes {
  FloatVector v;

  friend FloatLanes operator+(FloatLanes a, FloatLanes b) { return {a.v + b.v}; }
  friend FloatLanes operator-(FloatLanes a, FloatLanes b) { return {a.v - b.v}; }
  friend FloatLanes operator*(FloatLanes a, FloatLanes b) { return {a.v * b.v}; }
  friend FloatLanes operator*(float a, FloatLanes b) { return {a * b.v}; }
  FloatLanes& operator+=(FloatLanes b) { return v += b.v, *this; }
};

struct DoubleLanes {
  DoubleVector v;

  friend DoubleLanes operator+(DoubleLanes a, DoubleLanes b) { return {a.v + b.v}; }
  friend DoubleLanes operator-(DoubleLanes a, DoubleLanes b) { return {a.v - b.v}; }
  friend DoubleLanes operator-(double a, DoubleLanes b) { return {a - b.v}; }
  friend DoubleLanes operator*(DoubleLanes a, DoubleLanes b) { return {a.v * b.v}; }
  friend DoubleLanes operator*(DoubleLanes a, double b) { return {a.v * b}; }
  friend DoubleLanes operator*(double a, DoubleLanes b) { return {a * b.v}; }
  friend LaneMask operator==(DoubleLanes a, DoubleLanes b) { return {a.v == b.v}; }
  friend LaneMask operator<(DoubleLanes a, DoubleLanes b) { return {a.v < b.v}; }
  friend LaneMask operator>(DoubleLanes a, double b) { return {a.v > b}; }
  DoubleLanes& operator+=(DoubleLanes b) { return v += b.v, *this; }
};

/// The functions of kernels/body/voxelize/coverage.h for lanes.
inline DoubleLanes clamp01_finite(DoubleLanes x) {
  const DoubleVector zero{}, one = zero + 1, positive = x.v > zero ? x.v : zero;
  return {positive < one ? positive : one};
}
inline DoubleLanes at_most(DoubleLanes x, double high) {
  const DoubleVector limit = DoubleVector{} + high;
  return {limit < x.v ? limit : x.v};
}
inline DoubleLanes select(LaneMask mask, DoubleLanes a, DoubleLanes b) { return {mask.v ? a.v : b.v}; }
inline DoubleLanes value_or_zero(LaneMask mask, DoubleLanes a) { return {mask.v ? a.v : DoubleVector{}}; }
inline FloatLanes rounded_to_float(DoubleLanes x) { return {__builtin_convertvector(x.v, FloatVector)}; }

}  // namespace gigabake::kernels
