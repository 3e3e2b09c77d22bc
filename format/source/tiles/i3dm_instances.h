/// 3D Tiles 1.0 "Instanced 3D Model": where the instances stand.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "format/source/tiles/feature_table.h"
#include "lattice/frames.h"

namespace gigabake {

/// In the tile's z-up frame, RTC_CENTER left to the caller. Positions plain or quantized; orientation by NORMAL_UP and
/// NORMAL_RIGHT (plain or octahedral), else by EAST_NORTH_UP, else none; scale uniform or not.
/// EAST_NORTH_UP holds at the instance's place on the earth, which world_from_tile and `rtc_center` lead to: a place
/// that is not at the earth's surface has no east, and its instances keep the tile's axes.
/// Errors  InputError: no instances' length or positions, more than 2^24 instances, values beyond the table, one of the
///         two normals alone, a transform that is not finite.
std::vector<Affine<World, World>> i3dm_instances(const std::filesystem::path& file, const FeatureTable& table,
                                                 const Affine<World, World>& world_from_tile,
                                                 const std::array<double, 3>& rtc_center);

}  // namespace gigabake
