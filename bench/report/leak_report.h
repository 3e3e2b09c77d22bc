/// Reports of `bench accuracy --leaks` as JSON and Markdown.
#pragma once

#include <string>

#include "bench/accuracy/leaks/leak_bench.h"

namespace gigabake::bench {

/// Returns one sentence: the worst leak of an opaque surface, and whether leaks are bounded.
std::string verdict(const LeakBench& bench);

/// Returns the errors of every image of every scene.
std::string to_json(const LeakBench& bench);

/// Returns the conclusion; for each family a table of its views and a table of its scenes; a description of the
/// columns.
std::string to_markdown(const LeakBench& bench);
/// Returns the conclusion and one table of all views, as part of a larger report.
std::string leaks_in_short(const LeakBench& bench);

}  // namespace gigabake::bench
