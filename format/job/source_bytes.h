/// A scene's sources as bytes: rank 0 opens them once, and the bake processes of all ranks are told what it found.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "format/source/source.h"

namespace gigabake {

/// Exact   sources_from_bytes() returns the same value.
/// Cost    Some 50 bytes a tile where neighbours share a folder and a placement, 48 more where only the placement's
///         translation differs; at most some 250 and its names.
std::vector<std::uint8_t> to_bytes(const SceneSources& sources);

/// Opens the archives that tiles lie in, each once, and looks at no other file.
/// Cost    Memory follows the bytes: at most some hundred times as much, however hostile they are.
/// Errors  InputError: malformed bytes, or an archive that cannot be opened here.
SceneSources sources_from_bytes(std::span<const std::uint8_t> bytes);

}  // namespace gigabake
