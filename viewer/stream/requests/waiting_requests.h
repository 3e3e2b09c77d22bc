/// The requests of rays that wait for pages. Requests that lack the same pages form a group, so that a pass tests the
/// pages of each group instead of answering each request again.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <vector>

#include "viewer/stream/pager.h"

namespace gigabake {

/// Sorts the pages and removes duplicates. Threads prepare the argument of WaitingRequests::add() with it, because only
/// one thread may call add().
void sort_unique(std::vector<PageKey>& pages);

/// A number per request, at first 0. Requests are small numbers: twice the place of a node in the pool. Memory is
/// allocated in blocks, so that no call takes much longer than others.
class NumberByRequest {
 public:
  std::uint32_t at(std::uint32_t request) const {
    const std::size_t block = request / block_size;
    return block < blocks_.size() && !blocks_[block].empty() ? blocks_[block][request % block_size] : 0;
  }
  std::uint32_t& operator[](std::uint32_t request) {
    const std::size_t block = request / block_size;
    if (block >= blocks_.size()) blocks_.resize(block + 1);
    if (blocks_[block].empty()) blocks_[block].resize(block_size);
    return blocks_[block][request % block_size];
  }
  void clear() { blocks_.clear(); }

 private:
  static constexpr std::uint32_t block_size = 1 << 14;
  std::vector<std::vector<std::uint32_t>> blocks_;
};

/// All members but waits() must be called from one thread.
class WaitingRequests {
 public:
  /// Begins a pass of the pager: releases the requests whose pages are all resident or damaged, and resets the urgency
  /// of all groups. Call it after Pager::begin_pass().
  /// Cost    One search per page of a group.
  void begin_pass(const Pager& pager);

  /// Returns whether the request waits. Its pages are then at least as urgent as `rank`; the smallest rank is the most
  /// urgent. Several threads may call waits() concurrently.
  bool waits(std::uint32_t request, std::uint64_t rank);

  /// Lets the request wait until all pages of `missing` are resident or damaged.
  /// Range   `missing` is not empty; it may contain duplicates.
  /// Cost    Less after sort_unique().
  void add(std::uint32_t request, std::uint64_t rank, const std::vector<PageKey>& missing);

  /// Returns the pages of requests that waits() or add() named in this pass, the most urgent first. A page may occur
  /// several times.
  std::vector<PageKey> pages_by_urgency() const;

  /// Releases all requests.
  void clear();

 private:
  static constexpr std::uint64_t no_rank = std::numeric_limits<std::uint64_t>::max();

  struct Group {
    std::vector<PageKey> pages;    ///< sorted, without duplicates; empty: released
    std::uint64_t rank = no_rank;  ///< the smallest rank of its requests in this pass; waits() sets it atomically
    std::vector<std::uint32_t> requests;  ///< that were added to the group
  };

  void release(std::uint32_t number);
  std::uint32_t group_for(const std::vector<PageKey>& pages);

  std::vector<Group> groups_;
  std::uint32_t latest_ = 0;             ///< the group of the latest request; siblings often lack the same pages
  std::vector<std::uint32_t> released_;  ///< numbers of groups_ for new groups
  std::map<std::vector<PageKey>, std::uint32_t> group_of_pages_;  ///< of groups that are not released
  NumberByRequest group_of_request_;                              ///< 1 + the number of the group, or 0
};

}  // namespace gigabake
