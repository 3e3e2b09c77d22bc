/// The requests of rays that wait for pages. Requests that lack the same pages form a group, so that a pass tests the
/// pages of each group instead of answering each request again.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <unordered_map>
#include <vector>

#include "viewer/stream/pager.h"

namespace gigabake {

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
  void add(std::uint32_t request, std::uint64_t rank, std::vector<PageKey> missing);

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

  std::vector<Group> groups_;
  std::vector<std::uint32_t> released_;                           ///< numbers of groups_ for new groups
  std::map<std::vector<PageKey>, std::uint32_t> group_of_pages_;  ///< of groups that are not released
  std::unordered_map<std::uint32_t, std::uint32_t> group_of_request_;
};

}  // namespace gigabake
