/// What `bench accuracy --motion` found, for programs and for readers.
#pragma once

#include <string>

#include "bench/accuracy/motion_bench.h"

namespace gigabake::bench {

std::string to_json(const MotionBench& bench);
/// The worst in one sentence, and a table of all pairs.
std::string to_markdown(const MotionBench& bench);

}  // namespace gigabake::bench
