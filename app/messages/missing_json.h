/// Missing data of a scene in the JSON of `info` and `verify`.
#pragma once

#include <nlohmann/json.hpp>

#include "format/scene/check/verify.h"

namespace gigabake::app {

inline nlohmann::ordered_json json_of_missing(const MissingData& missing) {
  return {{"cells", missing.cells},
          {"planned_cells", missing.planned_cells},
          {"overviews", missing.overviews},
          {"inputs", missing.inputs}};
}

}  // namespace gigabake::app
