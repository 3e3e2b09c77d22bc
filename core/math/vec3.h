/// Triples of numbers along the axes x, y and z, for host and device.
#pragma once

#include <cmath>
#include <compare>
#include <cstdint>

#include "core/base/host_device.h"

namespace gigabake {

/// A vector, a point or the size of a box.
/// Space   The layout is that of T[3]. Without an initializer, the components are indeterminate.
/// Exact   Operators are component-wise. dot() adds the products of x, then y, then z.
template <class T>
struct Vec3 {
  using value_type = T;
  T v[3];

  /// Returns a vector with three equal components.
  GB_HD static constexpr Vec3 all(T value) { return {value, value, value}; }
  /// Returns the vector of of_axis(0), of_axis(1) and of_axis(2), called in this order.
  template <class OfAxis>
  GB_HD static constexpr Vec3 by_axis(const OfAxis& of_axis) {
    return {of_axis(0), of_axis(1), of_axis(2)};
  }
  /// Converts the first three elements of an array.
  template <class Array>
  GB_HD static constexpr Vec3 from(const Array& a) {
    return {T(a[0]), T(a[1]), T(a[2])};
  }
  /// Converts each component. Device code writes static_cast, because nvcc 13 reads Vec3<U>(v) as a list of components.
  template <class U>
  GB_HD constexpr explicit operator Vec3<U>() const {
    return {U(v[0]), U(v[1]), U(v[2])};
  }

  /// Returns the components in the order z, y, x, in which cells and pages are sorted.
  GB_HD constexpr Vec3 zyx() const { return {v[2], v[1], v[0]}; }

  GB_HD constexpr T& operator[](std::size_t axis) { return v[axis]; }
  GB_HD constexpr const T& operator[](std::size_t axis) const { return v[axis]; }
  GB_HD constexpr T* begin() { return v; }
  GB_HD constexpr T* end() { return v + 3; }
  GB_HD constexpr const T* begin() const { return v; }
  GB_HD constexpr const T* end() const { return v + 3; }

  /// Compares x, then y, then z.
  friend constexpr auto operator<=>(const Vec3&, const Vec3&) = default;
  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;

  friend GB_HD constexpr Vec3 operator+(const Vec3& a, const Vec3& b) {
    return {a.v[0] + b.v[0], a.v[1] + b.v[1], a.v[2] + b.v[2]};
  }
  friend GB_HD constexpr Vec3 operator-(const Vec3& a, const Vec3& b) {
    return {a.v[0] - b.v[0], a.v[1] - b.v[1], a.v[2] - b.v[2]};
  }
  friend GB_HD constexpr Vec3 operator*(const Vec3& a, T k) { return {a.v[0] * k, a.v[1] * k, a.v[2] * k}; }
  friend GB_HD constexpr Vec3 operator/(const Vec3& a, T k) { return {a.v[0] / k, a.v[1] / k, a.v[2] / k}; }
  /// Shifts integers; a shift to the right rounds down.
  friend GB_HD constexpr Vec3 operator>>(const Vec3& a, int bits) {
    return {a.v[0] >> bits, a.v[1] >> bits, a.v[2] >> bits};
  }
  friend GB_HD constexpr Vec3 operator<<(const Vec3& a, int bits) {
    return {a.v[0] << bits, a.v[1] << bits, a.v[2] << bits};
  }
  GB_HD constexpr Vec3& operator+=(const Vec3& b) { return *this = *this + b; }

  /// Returns the component-wise minimum. If two components are equal or not ordered, returns that of `a`, like
  /// std::min.
  friend GB_HD constexpr Vec3 min_by_axis(const Vec3& a, const Vec3& b) {
    return {b.v[0] < a.v[0] ? b.v[0] : a.v[0], b.v[1] < a.v[1] ? b.v[1] : a.v[1], b.v[2] < a.v[2] ? b.v[2] : a.v[2]};
  }
  /// Returns the component-wise maximum. If two components are equal or not ordered, returns that of `a`, like
  /// std::max.
  friend GB_HD constexpr Vec3 max_by_axis(const Vec3& a, const Vec3& b) {
    return {a.v[0] < b.v[0] ? b.v[0] : a.v[0], a.v[1] < b.v[1] ? b.v[1] : a.v[1], a.v[2] < b.v[2] ? b.v[2] : a.v[2]};
  }
  friend GB_HD constexpr T dot(const Vec3& a, const Vec3& b) {
    return (a.v[0] * b.v[0] + a.v[1] * b.v[1]) + a.v[2] * b.v[2];
  }
  /// Returns |x| + |y| + |z|.
  friend GB_HD constexpr T sum_of_magnitudes(const Vec3& a) {
    return (a.v[0] < 0 ? -a.v[0] : a.v[0]) + (a.v[1] < 0 ? -a.v[1] : a.v[1]) + (a.v[2] < 0 ? -a.v[2] : a.v[2]);
  }
  /// Returns the Euclidean length: the square root of dot(a, a).
  /// Range   T is a floating-point type.
  friend GB_HD T length(const Vec3& a) { return std::sqrt(dot(a, a)); }
  friend GB_HD constexpr Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a.v[1] * b.v[2] - a.v[2] * b.v[1], a.v[2] * b.v[0] - a.v[0] * b.v[2], a.v[0] * b.v[1] - a.v[1] * b.v[0]};
  }
};

using Vec3d = Vec3<double>;
using Vec3i64 = Vec3<std::int64_t>;

}  // namespace gigabake
