/// Extensions of a glTF object in tinygltf's types.
#pragma once

#include <tiny_gltf.h>

#include "format/source/json/json_parse.h"

namespace gigabake {

/// Returns a value. Null, empty lists and empty objects have none, as in tinygltf's parser, so their owner lacks them.
/// A whole number that is too large for an int becomes a double.
tinygltf::Value value_of(const Json& json);

/// Returns the extensions of an object. An extension that is not read has no members: its value can be large.
tinygltf::ExtensionMap extensions_of(const Json& object);

}  // namespace gigabake
