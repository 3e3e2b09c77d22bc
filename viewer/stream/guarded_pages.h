/// Pages of a producer that is somebody else's: whatever it does, what comes is a page that holds together, or a reason
/// why there is none, and never late.
#pragma once

#include <cstdint>

#include "viewer/stream/page.h"

namespace gigabake {

struct ProducerLimits {
  double seconds = 30;                                       ///< for a page; 0: no limit
  int most_late = 3;                                         ///< after so many late pages it is not asked again
  std::uint64_t most_page_bytes = std::uint64_t(256) << 20;  ///< Page::bytes()
};

/// A producer that is late runs on in a thread of its own, and its page is thrown away: whatever it uses must outlive
/// that. It may be asked by several threads at once, and not by those that ask this.
/// Errors  InputError, of the source that is returned: the producer threw, is late, or gave a page that is larger than
///         the limit, or not of the key, whose columns do not agree, or that lacks the scene's normals.
PageSource guarded_pages(PageSource producer, const SceneHeader& scene, const ProducerLimits& limits = {});

}  // namespace gigabake
