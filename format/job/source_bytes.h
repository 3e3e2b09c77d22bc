/// Serialization of a scene's sources: rank 0 opens them once and sends the result to the bake processes of all ranks.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "format/source/source.h"

namespace gigabake {

/// Serializes the sources.
/// Exact   sources_from_bytes() returns the same value.
/// Cost    About 50 bytes per tile if consecutive tiles share a folder and a placement, 48 more if their placements
///         differ only in translation. A tile takes at most about 250 bytes plus its names.
std::vector<std::uint8_t> to_bytes(const SceneSources& sources);

/// Restores the sources. Opens each archive that contains tiles once; accesses no other file.
/// Cost    Memory is at most about a hundred times the size of the bytes, even for malicious input.
/// Errors  InputError if the bytes are malformed, or if an archive cannot be opened on this host.
SceneSources sources_from_bytes(std::span<const std::uint8_t> bytes);

}  // namespace gigabake
