#include "format/verify.h"

#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/commands.h"
#include "app/status_text.h"

namespace gigabake::app {

void add_verify(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand(
      "verify", "Check every checksum, reference and invariant of a baked scene; exit code 1 on a fault");
  auto scene = std::make_shared<std::string>();
  auto json = std::make_shared<bool>(false);
  command->add_option("SCENE", *scene, "OUT/scene.xml")->required();
  command->add_flag("--json", *json, "print the answer as JSON");
  command->callback([scene, json, &exit_code] {
    const VerifyResult r = verify_scene(*scene, int(std::thread::hardware_concurrency()));
    exit_code = r.faults.empty() ? complete : failed;
    if (*json) {
      nlohmann::ordered_json j{{"cells", r.cells}, {"voxels", r.voxels}, {"bytes", r.bytes}, {"faults", r.faults}};
      fmt::print("{}\n", j.dump(2));
      return;
    }
    for (const std::string& fault : r.faults) fmt::print("{}\n", fault);
    fmt::print("{} cells, {} voxels, {}: {}\n", r.cells, r.voxels, readable_bytes(r.bytes),
               r.faults.empty() ? std::string("whole") : fmt::format("{} faults", r.faults.size()));
  });
}

}  // namespace gigabake::app
