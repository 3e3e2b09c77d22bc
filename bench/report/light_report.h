/// Reports of `bench accuracy --light` as JSON and Markdown.
#pragma once

#include <string>

#include "bench/accuracy/light_bench.h"

namespace gigabake::bench {

std::string to_json(const LightBench& bench);
/// Returns one sentence with the means, and a table of all views.
std::string to_markdown(const LightBench& bench);

}  // namespace gigabake::bench
