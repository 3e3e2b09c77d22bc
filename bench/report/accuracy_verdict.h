/// Conclusions from the tables of `bench accuracy`, and descriptions of their columns.
#pragma once

#include <string>

#include "bench/accuracy/accuracy_bench.h"
#include "bench/hard/hard_bench.h"

namespace gigabake::bench {

/// Returns two sentences: the quality of the first setting, and the settings that are best in some respect.
std::string verdict(const AccuracyBench& bench);
/// Returns two sentences: whether all bounds hold, and the number that is nearest to its bound or beyond it.
std::string verdict(const HardBench& bench);
/// Returns one sentence: how many goals are met.
std::string goals_verdict(const HardBench& bench);

/// Returns a Markdown list of the tables' columns.
std::string accuracy_columns();
std::string hard_columns();
std::string goals_columns();

}  // namespace gigabake::bench
