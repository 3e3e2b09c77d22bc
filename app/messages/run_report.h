/// The part of a bake's report about the run: rates, work, energy, and the stage that bounds the run.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "cluster/bake/bake.h"

namespace gigabake::app {

/// Returns one line without a line feed.
std::string run_text(const BakeSummary& summary);
/// Adds the member "run". Shares of the time add up to 1, or are all 0 if no stage has run.
void add_run(const BakeSummary& summary, nlohmann::ordered_json& report);

}  // namespace gigabake::app
