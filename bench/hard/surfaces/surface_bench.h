/// Measures surfaces as real scenes have them: covered area, light and normals of thin walls, sunlight inside of a
/// closed house. References are closed forms and exact silhouettes.
#pragma once

#include <filesystem>
#include <functional>

#include "bench/hard/hard_case.h"

namespace gigabake::bench {

/// Name of the cases' group.
inline constexpr const char* surfaces_group = "surfaces";

/// Bakes and renders all cases with default settings and calls `done` with each result. A failure of a case is part of
/// its result. Images are rendered on the CPU.
/// Cost    About a minute of a core.
void run_surface_cases(const std::filesystem::path& out, const HardMachine& machine,
                       const std::function<void(HardResult&&)>& done);

}  // namespace gigabake::bench
