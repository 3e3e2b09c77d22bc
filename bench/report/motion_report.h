/// Reports of `bench accuracy --motion` as JSON and Markdown.
#pragma once

#include <string>

#include "bench/accuracy/motion_bench.h"

namespace gigabake::bench {

std::string to_json(const MotionBench& bench);
/// Returns one sentence with the worst numbers, and a table of all pairs.
std::string to_markdown(const MotionBench& bench);

}  // namespace gigabake::bench
