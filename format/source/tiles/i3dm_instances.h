/// 3D Tiles 1.0 "Instanced 3D Model": transforms of the instances.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "core/math/frames.h"
#include "format/source/tiles/feature_table.h"

namespace gigabake {

/// Returns the instances' transforms in the tile's z-up frame; the caller adds RTC_CENTER. Positions are plain or
/// quantized. Orientation is given by NORMAL_UP and NORMAL_RIGHT (plain or octahedral), else by EAST_NORTH_UP, else it
/// is that of the tile. Scale is uniform or not.
/// EAST_NORTH_UP refers to the instance's place on the earth, computed from world_from_tile and `rtc_center`. An
/// instance that is not at the earth's surface has no east and keeps the tile's axes.
/// Errors  InputError: INSTANCES_LENGTH or positions are missing, there are more than 2^24 instances, or values exceed
///         the table. Also if only one of the two normals exists, or a transform is not finite.
std::vector<Affine<World, World>> i3dm_instances(const std::filesystem::path& file, const FeatureTable& table,
                                                 const Affine<World, World>& world_from_tile,
                                                 const std::array<double, 3>& rtc_center);

}  // namespace gigabake
