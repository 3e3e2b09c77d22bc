/// A set of small integers with queries for the next member above or below a number.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace gigabake {

/// A hierarchical bit set.
/// Range   Members are below the initial size, and the initial size is at most 2^32 - 64.
/// Cost    1 + 1/64 bits of memory per number. Every call takes one step per factor of 64 in the size.
class IndexSet {
 public:
  /// Creates the set of all numbers below `size`.
  explicit IndexSet(std::uint32_t size);

  void erase(std::uint32_t rank);
  /// Returns the smallest member that is at least `rank`; any `rank` is valid.
  std::optional<std::uint32_t> at_or_after(std::uint32_t rank) const;
  /// Returns the largest member below `rank`.
  std::optional<std::uint32_t> before(std::uint32_t rank) const;

 private:
  std::uint32_t lowest_below(std::size_t level, std::uint64_t word) const;
  std::uint32_t highest_below(std::size_t level, std::uint64_t word) const;

  std::vector<std::vector<std::uint64_t>> levels_;  ///< bit b of level k+1 is set if word b of level k is not zero
};

}  // namespace gigabake
