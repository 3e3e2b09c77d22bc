/// Reports of `bench accuracy --hard` as JSON and Markdown.
#pragma once

#include <string>

#include "bench/hard/hard_bench.h"

namespace gigabake::bench {

std::string to_json(const HardBench& bench);
/// Returns the conclusion and a table with one row per case; ties have one row per group unless a bound fails. Then
/// lists the violated bounds, describes the columns, and appends the leaks of three planes.
std::string to_markdown(const HardBench& bench);

}  // namespace gigabake::bench
