#include <fmt/format.h>
#include <vector>

#include "core/base/pluralize.h"
#include "format/scene/check/verify.h"

namespace gigabake {

MissingData missing_data(const SceneHeader& scene, std::uint64_t cells) {
  MissingData missing;
  for (const SceneLoss& loss : scene.losses)
    ++(loss.name.starts_with("cell ")     ? missing.cells
       : loss.name.starts_with("parent ") ? missing.overviews
                                          : missing.inputs);
  if (missing.cells != 0) missing.overviews = 0;
  missing.planned_cells = cells + missing.cells;
  return missing;
}

std::string describe(const MissingData& missing) {
  std::vector<std::string> parts;
  if (missing.cells != 0)
    parts.push_back(fmt::format("{} of {}", missing.cells, pluralize(missing.planned_cells, "cell")));
  if (missing.overviews != 0) parts.push_back(pluralize(missing.overviews, "overview"));
  if (missing.inputs != 0) parts.push_back(pluralize(missing.inputs, "input"));
  std::string text = parts.front();
  for (std::size_t i = 1; i < parts.size(); ++i) text += (i + 1 == parts.size() ? " and " : ", ") + parts[i];
  return text + (missing.cells + missing.overviews + missing.inputs == 1 ? " is missing" : " are missing");
}

}  // namespace gigabake
