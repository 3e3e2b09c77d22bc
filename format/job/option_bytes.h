/// A bake's options as bytes, for the process that bakes.
#pragma once

#include "format/source/source.h"
#include "lattice/bytes.h"
#include "lattice/parameters.h"

namespace gigabake {

void put(ByteWriter& writer, const SourceOptions& options);
void put(ByteWriter& writer, const BakeParameters& parameters);
/// Errors  InputError: bytes that end early, or values that these options cannot have.
SourceOptions get_source_options(ByteReader& reader);
/// Errors  InputError, as above; UsageError as check().
BakeParameters get_parameters(ByteReader& reader);

}  // namespace gigabake
