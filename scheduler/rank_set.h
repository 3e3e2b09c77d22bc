/// A set of small integers that knows its neighbours: which member is the next one above or below a number.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace gigabake {

/// Range  Numbers below the size that it was made with, at most 2^32 - 64.
/// Cost   One bit a number and a sixty-fourth more; every call takes one step for each factor of 64 in the size.
class RankSet {
 public:
  /// Holds every number below `size`.
  explicit RankSet(std::uint32_t size);

  void erase(std::uint32_t rank);
  /// The smallest member that is at least `rank`; any `rank`.
  std::optional<std::uint32_t> at_or_after(std::uint32_t rank) const;
  /// The largest member below `rank`.
  std::optional<std::uint32_t> before(std::uint32_t rank) const;

 private:
  std::uint32_t lowest_below(std::size_t level, std::uint64_t word) const;
  std::uint32_t highest_below(std::size_t level, std::uint64_t word) const;

  std::vector<std::vector<std::uint64_t>> levels_;  ///< a bit of level k+1: some bit of this word of level k is set
};

}  // namespace gigabake
