/// Placements of meshes in a glTF scene.
#pragma once

#include <cstdint>
#include <functional>

#include "core/math/frames.h"
#include "format/source/gltf/load.h"
#include "format/source/source.h"
#include "format/source/source_warning.h"

namespace gigabake {

struct Gltf;  ///< the frame of a glTF scene, before the rotation to z up

struct MeshPlacement {
  int mesh = 0;
  Affine<Gltf, Local> gltf_from_local;
  std::int32_t lod = not_stated;          ///< level of its node or of the nearest node above that has one
  std::int32_t voxel_class = not_stated;  ///< class of its instance's id (instance_ids.h)
};

/// Calls visit() for each placement of the default scene, else of the first scene, else of all root nodes. Parents
/// precede their children. Each instance of EXT_mesh_gpu_instancing is a separate placement.
/// Errors  InputError: a transform is not finite, instancing attributes differ in length or have a wrong type, or there
///         are more than max_placements placements. UsageError of classes_of_instances().
void for_each_placement(const TileRef& tile, const GltfDocument& document, SourceWarnings& warnings,
                        const std::function<void(const MeshPlacement&)>& visit);

}  // namespace gigabake
