/// What `bench accuracy --hard` found, for programs and for readers.
#pragma once

#include <string>

#include "bench/hard/hard_bench.h"

namespace gigabake::bench {

std::string to_json(const HardBench& bench);
/// The verdict; a table, in Markdown: a row a case; ties, a row a group unless a bound fails. Then the bounds that do
/// not hold, and what columns are; last the leaks of a few planes.
std::string to_markdown(const HardBench& bench);

}  // namespace gigabake::bench
