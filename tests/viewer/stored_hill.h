/// A small scene in a folder, as a bake writes it.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>

namespace gigabake {

/// Writes ground of 32 × 32 m that rises to the north; write_scene_of() defines the voxel size.
void write_hill(const std::filesystem::path& scene_xml, const std::array<std::uint8_t, 4>& rgba = {90, 140, 60, 255});

}  // namespace gigabake
