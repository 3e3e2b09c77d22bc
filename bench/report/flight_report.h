/// Reports of `bench accuracy --flight` as JSON and Markdown.
#pragma once

#include <string>

#include "bench/flight/flight_bench.h"

namespace gigabake::bench {

std::string to_json(const FlightBench& bench);
/// Returns a table of the flights and a table of the still images.
std::string to_markdown(const FlightBench& bench);

}  // namespace gigabake::bench
