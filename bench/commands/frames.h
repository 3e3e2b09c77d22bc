/// Output of `bench render` for the streaming renderer.
#pragma once

#include <nlohmann/json.hpp>

#include "bench/frame_bench.h"

namespace gigabake::app {

void print_text(const bench::FrameBench& b);
nlohmann::ordered_json to_json(const bench::FrameBench& b);

}  // namespace gigabake::app
