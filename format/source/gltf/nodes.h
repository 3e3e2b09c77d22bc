/// Placements of meshes in a glTF scene.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>

#include "core/math/frames.h"
#include "format/source/gltf/load.h"

namespace gigabake {

struct Gltf;  ///< the frame of a glTF scene, before the rotation to z up

struct MeshPlacement {
  int mesh = 0;
  Affine<Gltf, Local> gltf_from_local;
};

/// Calls visit() for each placement of the default scene, else of the first scene, else of all root nodes. Parents
/// precede their children. Each instance of EXT_mesh_gpu_instancing is a separate placement.
/// Errors  InputError: a transform is not finite, instancing attributes differ in length or have a wrong type, or there
///         are more than max_placements placements.
void for_each_placement(const std::filesystem::path& file, const GltfDocument& document,
                        const std::function<void(const MeshPlacement&)>& visit);

}  // namespace gigabake
