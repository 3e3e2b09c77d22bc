/// Every placement of a mesh in a glTF scene.
#pragma once

#include <filesystem>
#include <tiny_gltf.h>
#include <vector>

#include "format/frames.h"

namespace gigabake {

struct Gltf;  ///< Frame: the glTF scene's own, before any turn to z up.

struct MeshPlacement {
  int mesh = 0;
  Affine<Gltf, Local> gltf_from_local;
};

/// Of the default scene (else the first; else all root nodes), parents before children; EXT_mesh_gpu_instancing
/// written out. Errors  InputError: a transform that is not finite, instancing attributes that differ in length.
std::vector<MeshPlacement> mesh_placements(const std::filesystem::path& file, const tinygltf::Model& model);

}  // namespace gigabake
