/// A 128-bit content hash. Hashes of parts can be added in any order.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/host_device.h"

namespace gigabake {

struct Hash128 {
  std::uint64_t lo = 0, hi = 0;
  friend bool operator==(const Hash128&, const Hash128&) = default;
  /// Adds mod 2^128: combines hashes of disjoint voxel sets in any order.
  GB_HD Hash128& operator+=(const Hash128& o) {
    lo += o.lo;
    hi += o.hi + (lo < o.lo ? 1 : 0);
    return *this;
  }
  /// Subtracts mod 2^128: the inverse of the addition.
  GB_HD Hash128& operator-=(const Hash128& o) {
    hi -= o.hi + (lo < o.lo ? 1 : 0);
    lo -= o.lo;
    return *this;
  }
  std::string hex() const;  ///< 32 lower-case digits, hi first
  static std::optional<Hash128> from_hex(std::string_view text);
};

}  // namespace gigabake
