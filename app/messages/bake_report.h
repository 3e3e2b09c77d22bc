/// What a bake or a plan says at its end: text for people, JSON for programs.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/commands/plan_sizes.h"
#include "cluster/bake.h"
#include "scheduler/prior.h"

namespace gigabake::app {

/// On standard output.
void print_report(const BakeSummary& summary, const std::filesystem::path& out);
/// prior: what OUT has of the plan; none: no OUT was named. lists_cells: one line per cell, too.
void print_report(const BakePlan& plan, const std::optional<PriorResults>& prior, const PlanSizes& sizes,
                  bool lists_cells);
std::string json_report(const BakeSummary& summary, const std::filesystem::path& out);
void print_json_report(const BakePlan& plan, const std::optional<PriorResults>& prior, const PlanSizes& sizes);

/// On standard error: that sources cannot say where their vertices are as finely as voxels are small. Nothing where
/// they can.
void warn_of(const SourcePrecision& precision);

/// On standard error, and last: nobody should have to look for what is missing. After fifty, how many more.
void print_losses(const std::vector<SceneLoss>& losses);

}  // namespace gigabake::app
