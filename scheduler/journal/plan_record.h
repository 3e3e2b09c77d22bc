/// OUT/plan: the cells of the running bake, from which viewers show its progress. Rank 0 writes the file when it begins
/// to dispatch cells, appends each cell that failed permanently, and removes the file at the end of the bake. After a
/// bake that was killed the file remains; the next bake replaces it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "format/job/cell_job.h"

namespace gigabake {

struct PlanRecord {
  SceneHeader header;            ///< lattice, place, channels, parameters and bounds; other members are unset
  std::vector<SceneCell> cells;  ///< cell_of() each planned cell, with its estimated triangles
  std::vector<std::vector<std::uint32_t>> tiles;  ///< per cell: indices into tile_names, ascending
  std::vector<std::string> tile_names;
};

struct FailedCell {
  std::uint32_t cell = 0;  ///< index into PlanRecord::cells
  std::string error;       ///< one line
};

/// Returns the record of the cells in `jobs`, without overviews.
PlanRecord plan_record_of(const std::vector<CellJob>& jobs, SceneHeader header, std::vector<std::string> tile_names);

/// Replaces the file atomically, without flushing to disk.
/// Errors  InputError if the file cannot be written.
void write_plan_record(const std::filesystem::path& path, const PlanRecord& record);
/// Appends a failure to the file, if it exists.
/// Errors  InputError if the file cannot be written.
void append_failed_cell(const std::filesystem::path& path, const FailedCell& failed);

/// A plan record in a file, and the failures that were appended to it.
struct StoredPlan {
  PlanRecord record;
  std::uint64_t end = 0;  ///< size of the record in the file; failures follow
};
/// Reads the record without its failures.
/// Errors  InputError: the file does not exist, is malformed, or was written by another version of the program.
StoredPlan read_plan_record(const std::filesystem::path& path);
/// Reads the complete failures from byte `at` of the file on, and advances `at` to their end.
/// Errors  InputError: the file does not exist or cannot be read.
std::vector<FailedCell> read_failed_cells(const std::filesystem::path& path, std::uint64_t& at);

}  // namespace gigabake
