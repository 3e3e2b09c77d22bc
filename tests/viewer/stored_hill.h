/// A small scene in a folder, as a bake leaves it.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>

namespace gigabake {

/// Ground of 32 × 32 m that rises to the north; a voxel is as large as write_scene_of() makes it.
void write_hill(const std::filesystem::path& scene_xml, const std::array<std::uint8_t, 4>& rgba = {90, 140, 60, 255});

}  // namespace gigabake
