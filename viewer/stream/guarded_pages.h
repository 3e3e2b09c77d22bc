/// Validates the pages of an external producer. Each request returns a consistent page or throws with a reason, within
/// a time limit.
#pragma once

#include <cstdint>

#include "viewer/stream/page.h"

namespace gigabake {

struct ProducerLimits {
  double seconds = 30;                                      ///< for a page; 0: no limit
  int max_late = 3;                                         ///< after this many late pages it is not called again
  std::uint64_t max_page_bytes = std::uint64_t(256) << 20;  ///< Page::bytes()
};

/// Returns a source that calls and validates the producer. If there is a time limit, each call runs in its own thread.
/// A late call continues there and its page is discarded, so everything that the producer uses must outlive the call.
/// The producer may be called concurrently, and on other threads than the callers of the returned source.
/// Errors  InputError, from the returned source: the producer threw, is late, or gave a wrong page. A page is wrong if
///         it is larger than the limit, not of the key, inconsistent, or without the scene's normals.
PageSource guarded_pages(PageSource producer, const SceneHeader& scene, const ProducerLimits& limits = {});

}  // namespace gigabake
