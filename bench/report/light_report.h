/// What `bench accuracy --light` found, for programs and for readers.
#pragma once

#include <string>

#include "bench/accuracy/light_bench.h"

namespace gigabake::bench {

std::string to_json(const LightBench& bench);
/// The means in one sentence, and a table of all views.
std::string to_markdown(const LightBench& bench);

}  // namespace gigabake::bench
