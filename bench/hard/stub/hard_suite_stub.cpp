#include "bench/hard/hard_bench.h"
#include "core/base/error.h"

namespace gigabake::bench {

HardBench bench_hard(const HardBenchRequest&, const std::function<void(const HardResult&)>&) {
  throw UsageError("bench accuracy --hard: this gigabake was built without GMP; install libgmp-dev and build again");
}

}  // namespace gigabake::bench
