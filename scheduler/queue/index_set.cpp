#include "scheduler/queue/index_set.h"

#include <algorithm>
#include <bit>

namespace gigabake {

IndexSet::IndexSet(std::uint32_t size) {
  std::uint64_t bits = size;
  do {
    const std::uint64_t words = std::max<std::uint64_t>(1, (bits + 63) / 64);
    std::vector<std::uint64_t> level(words, ~std::uint64_t(0));
    if (bits % 64 != 0 || bits == 0) level.back() = (std::uint64_t(1) << (bits % 64)) - 1;
    levels_.push_back(std::move(level));
    bits = words;
  } while (bits > 1);
}

void IndexSet::erase(std::uint32_t rank) {
  std::uint64_t bit = rank;
  for (std::vector<std::uint64_t>& level : levels_) {
    std::uint64_t& word = level[bit / 64];
    word &= ~(std::uint64_t(1) << (bit % 64));
    if (word != 0) return;
    bit /= 64;
  }
}

/// Returns the lowest member in the subtree of a non-zero word of a level.
std::uint32_t IndexSet::lowest_below(std::size_t level, std::uint64_t word) const {
  for (;; --level) {
    word = word * 64 + std::uint64_t(std::countr_zero(levels_[level][word]));
    if (level == 0) return std::uint32_t(word);
  }
}

std::uint32_t IndexSet::highest_below(std::size_t level, std::uint64_t word) const {
  for (;; --level) {
    word = word * 64 + 63 - std::uint64_t(std::countl_zero(levels_[level][word]));
    if (level == 0) return std::uint32_t(word);
  }
}

std::optional<std::uint32_t> IndexSet::at_or_after(std::uint32_t rank) const {
  std::uint64_t bit = rank;  // on each level: the first bit to examine
  for (std::size_t level = 0; level < levels_.size(); ++level) {
    const std::uint64_t word = bit / 64;
    if (word >= levels_[level].size()) return std::nullopt;
    const std::uint64_t left = levels_[level][word] >> (bit % 64);
    if (left != 0) {
      const std::uint64_t found = bit + std::uint64_t(std::countr_zero(left));
      return level == 0 ? std::uint32_t(found) : lowest_below(level - 1, found);
    }
    bit = word + 1;
  }
  return std::nullopt;
}

std::optional<std::uint32_t> IndexSet::before(std::uint32_t rank) const {
  std::uint64_t end = std::min<std::uint64_t>(rank, levels_[0].size() * 64);  // on each level: end of the bits
  for (std::size_t level = 0; level < levels_.size() && end > 0; ++level) {
    const std::uint64_t last = end - 1, word = last / 64;
    const std::uint64_t left = levels_[level][word] << (63 - last % 64);
    if (left != 0) {
      const std::uint64_t found = last - std::uint64_t(std::countl_zero(left));
      return level == 0 ? std::uint32_t(found) : highest_below(level - 1, found);
    }
    end = word;
  }
  return std::nullopt;
}

}  // namespace gigabake
