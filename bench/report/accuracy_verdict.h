/// What the tables of `bench accuracy` come to, and what their columns are.
#pragma once

#include <string>

#include "bench/accuracy/accuracy_bench.h"
#include "bench/hard/hard_bench.h"

namespace gigabake::bench {

/// Two sentences: how good the first setting is, and which settings are the best at something.
std::string verdict(const AccuracyBench& bench);
/// Two sentences: whether all bounds hold, and which figure comes nearest to its bound or goes beyond it.
std::string verdict(const HardBench& bench);

/// A list in Markdown: each column of the tables.
std::string accuracy_columns();
std::string hard_columns();

}  // namespace gigabake::bench
