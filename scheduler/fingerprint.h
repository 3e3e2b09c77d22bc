/// The name of a cell's result: a hash of exactly what it is baked from.
#pragma once

#include <optional>
#include <span>

#include "format/cell_job.h"
#include "format/parameters.h"

namespace gigabake {

/// Raised whenever the kernels or the shard layout would give other bytes for the same inputs.
inline constexpr std::uint32_t kernel_version = 1;

/// tile_sources: TileSurvey::source of job.tiles, in that order.
Hash128 cell_fingerprint(const CellJob& job, const BakeParameters& parameters, const std::optional<Geodetic>& origin,
                         std::span<const Hash128> tile_sources);

}  // namespace gigabake
