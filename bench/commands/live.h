/// Output of `bench render --what live`.
#pragma once

#include <nlohmann/json.hpp>

#include "bench/live_bench.h"

namespace gigabake::app {

void print_text(const bench::LiveBench& b);
nlohmann::ordered_json to_json(const bench::LiveBench& b);

}  // namespace gigabake::app
