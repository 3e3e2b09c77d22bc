/// The header and the variable length records of a LAS file.
///
/// Source  ASPRS LAS Specification 1.4 - R15, tables 3, 7 and 24.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace gigabake {

/// The coordinates of all points, as the file's integers.
struct LasBounds {
  std::array<std::int32_t, 3> low, high;

  LasBounds() {
    low.fill(std::numeric_limits<std::int32_t>::max());
    high.fill(std::numeric_limits<std::int32_t>::min());
  }
};

struct LasHeader {
  std::string software, wkt;
  bool has_normals = false, has_classes = false;
  std::array<double, 3> scale{}, offset{};
};

/// Returns the length of a point's record: format 7, coverage, a normal of three floats, and a class.
inline std::uint16_t las_point_bytes(const LasHeader& header) {
  return std::uint16_t(37 + (header.has_normals ? 12 : 0) + (header.has_classes ? 2 : 0));
}

/// Returns the bytes before the first point. Their number does not depend on `points` and `bounds`.
/// Errors  InputError: the WKT exceeds the 65,535 bytes of a record.
std::vector<std::uint8_t> las_header(const LasHeader& header, std::uint64_t points, const LasBounds& bounds);

}  // namespace gigabake
