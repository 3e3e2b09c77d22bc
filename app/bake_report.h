/// What a bake or a plan says at its end: text for people, JSON for programs.
#pragma once

#include <filesystem>
#include <vector>

#include "cluster/bake.h"
#include "scheduler/bake_status.h"

namespace gigabake::app {

/// On standard output. status: as it was at the end.
void print_report(const BakeSummary& summary, const BakeStatus& status, const std::filesystem::path& out);
void print_report(const BakePlan& plan);
void print_json_report(const BakeSummary& summary, const BakeStatus& status, const std::filesystem::path& out);
void print_json_report(const BakePlan& plan);

/// On standard error, and last: nobody should have to look for what is missing.
void print_losses(const std::vector<SceneLoss>& losses);

}  // namespace gigabake::app
