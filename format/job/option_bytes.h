/// Serialization of a bake's options for the bake processes.
#pragma once

#include "core/io/bytes.h"
#include "core/octree/parameters.h"

namespace gigabake {

void put(ByteWriter& writer, const BakeParameters& parameters);
/// Reads the options that put() wrote.
/// Errors  InputError if the bytes end early; the errors of parameters_from_json().
BakeParameters get_parameters(ByteReader& reader);

}  // namespace gigabake
