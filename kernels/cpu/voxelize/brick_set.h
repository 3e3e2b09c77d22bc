/// A set of bricks of one level of a window, as a bitmap.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

namespace gigabake::kernels {

/// Bricks by Morton key.
/// Cost    One bit per brick of the window, whether it is in the set or not.
class BrickSet {
 public:
  explicit BrickSet(std::uint64_t bricks) : words_((bricks + 63) / 64, 0) {}

  bool contains(std::uint64_t key) const { return (words_[key / 64] >> key % 64 & 1) != 0; }
  /// Returns which children of a node are in the set: bit c is child c. `parent` is the node's key in the next coarser
  /// level.
  /// Range   The set has at least eight bricks.
  std::uint8_t children(std::uint64_t parent) const { return std::uint8_t(words_[parent / 8] >> 8 * (parent % 8)); }
  /// Adds a brick. Threads may add bricks concurrently, and call contains() during this.
  void insert(std::uint64_t key) {
    std::atomic_ref<std::uint64_t>(words_[key / 64]).fetch_or(std::uint64_t(1) << key % 64, std::memory_order_relaxed);
  }
  /// Tests a brick while other threads add bricks.
  bool contains_now(std::uint64_t key) {
    const std::atomic_ref<std::uint64_t> word(words_[key / 64]);
    return (word.load(std::memory_order_relaxed) >> key % 64 & 1) != 0;
  }
  /// Adds the parents of all bricks of the next finer level's set.
  void insert_parents_of(const BrickSet& finer) {
    for (std::uint64_t w = 0; w < finer.words_.size(); ++w)
      for (std::uint64_t rest = finer.words_[w], parent = 8 * w; rest != 0; rest >>= 8, ++parent)
        if ((rest & 255) != 0) insert(parent);
  }
  std::uint64_t bytes() const { return words_.size() * sizeof(std::uint64_t); }

 private:
  std::vector<std::uint64_t> words_;
};

}  // namespace gigabake::kernels
