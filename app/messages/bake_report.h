/// The final report of a bake or a plan: text for people, JSON for programs.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/messages/plan_sizes.h"
#include "cluster/bake/bake.h"
#include "scheduler/journal/cached_results.h"

namespace gigabake::app {

/// Prints the report of a bake on standard output.
void print_report(const BakeSummary& summary, const std::filesystem::path& out);
/// Prints the report of a plan on standard output. If `lists_cells`, also prints one line per cell. `prior` contains
/// the earlier results in SCENE; it is nullopt if no SCENE was given.
void print_report(const BakePlan& plan, const std::optional<CachedResults>& prior, const PlanSizes& sizes,
                  bool lists_cells);
std::string json_report(const BakeSummary& summary, const std::filesystem::path& out);
void print_json_report(const BakePlan& plan, const std::optional<CachedResults>& prior, const PlanSizes& sizes);

/// Warns on standard error if the coordinate resolution of sources is too coarse for the voxel size. Prints nothing
/// otherwise.
void warn_of(const SourcePrecision& precision);

/// Prints missing inputs on standard error. Call it last, so that the user sees them at the end. Prints at most 50
/// lines; the last line states how many inputs are not printed.
void print_losses(const std::vector<SceneLoss>& losses);

}  // namespace gigabake::app
