/// Placements of meshes in a glTF scene.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>

#include "core/math/frames.h"
#include "format/source/gltf/load.h"

namespace gigabake {

struct Gltf;  ///< Frame: the glTF scene's, before any rotation to z up.

struct MeshPlacement {
  int mesh = 0;
  Affine<Gltf, Local> gltf_from_local;
};

/// Calls visit() for each placement of the default scene (else the first; else all root nodes), parents before
/// children. Each instance of EXT_mesh_gpu_instancing is a separate placement.
/// Errors  InputError: a transform that is not finite, instancing attributes that differ in length or have another
///         type, more than max_placements.
void for_each_placement(const std::filesystem::path& file, const GltfDocument& document,
                        const std::function<void(const MeshPlacement&)>& visit);

}  // namespace gigabake
