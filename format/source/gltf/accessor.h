/// Values of a checked glTF accessor: strided, normalized, sparse.
#pragma once

#include <cstdint>
#include <tiny_gltf.h>
#include <vector>

namespace gigabake {

/// Items of `components` floats. Integer components are normalized where the accessor says so, else taken as numbers.
/// Components that the accessor lacks are `missing`.
std::vector<float> read_floats(const tinygltf::Model& model, int accessor, int components, float missing = 0);

/// Scalars as unsigned integers; floats are not indices and give nothing.
std::vector<std::uint32_t> read_indices(const tinygltf::Model& model, int accessor);

/// Distance between neighbouring values of read_floats() where components are integers (KHR_mesh_quantization); 0 where
/// they are floats, whose spacing follows the value.
float quantization_step(const tinygltf::Model& model, int accessor);

int component_count(const tinygltf::Model& model, int accessor);

}  // namespace gigabake
