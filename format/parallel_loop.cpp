#include "format/parallel_loop.h"

#include "format/parallel.h"

namespace gigabake {

ParallelLoop on_threads(int threads) {
  return [threads](std::size_t count, std::size_t grain, const auto& body) {
    parallel_ranges(count, grain, threads, body);
  };
}

}  // namespace gigabake
