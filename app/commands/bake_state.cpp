#include "app/commands/bake_state.h"

#include <nlohmann/json.hpp>

#include "app/messages/json_text.h"
#include "app/messages/status_text.h"
#include "cluster/watch/observed_status.h"
#include "core/base/error.h"

namespace gigabake::app {
namespace {

/// Returns the numbers of cells by the states that a viewer distinguishes.
nlohmann::ordered_json cells_json(const CellTally& c) {
  return {{"waiting", c.pending},
          {"baking", c.running},
          {"failed", c.quarantined},
          {"done", c.taken_over + c.done + c.empty}};
}

}  // namespace

std::string bake_status_json(const std::string& out) {
  try {
    const ObservedStatus seen = observe_status(out);
    const std::string line =
        seen.interrupted ? "interrupted: no process bakes this scene any more" : one_line(seen.status);
    return json_text({{"state", name_of(seen.status.state)},
                      {"interrupted", seen.interrupted},
                      {"line", line},
                      {"share_done", share_done(seen.status)},
                      {"cells", cells_json(seen.status.cells)}},
                     -1);
  } catch (const InputError&) {
    return "null";
  }
}

}  // namespace gigabake::app
