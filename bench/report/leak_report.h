/// What `bench accuracy --leaks` found, for programs and for readers.
#pragma once

#include <string>

#include "bench/accuracy/leaks/leak_bench.h"

namespace gigabake::bench {

/// One sentence: the worst leak of an opaque surface, and whether leaks are bounded.
std::string verdict(const LeakBench& bench);

/// Every picture of every scene.
std::string to_json(const LeakBench& bench);

/// The verdict; in Markdown, for each family a table of its views and one of its scenes; what columns are.
std::string to_markdown(const LeakBench& bench);
/// The verdict, and one table of all views: within a report of more.
std::string leaks_in_short(const LeakBench& bench);

}  // namespace gigabake::bench
