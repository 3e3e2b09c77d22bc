#include "app/process/missing_report.h"

#include <string>
#include <vector>

#include "app/commands.h"
#include "app/process/standard_streams.h"
#include "format/scene/check/verify.h"
#include "format/scene/paged_scene.h"
#include "format/system/message.h"

namespace gigabake::app {
namespace {

struct RecordedScene {
  std::filesystem::path file;
  MissingData missing;
};

/// Returns the scenes that the command of this process reads.
std::vector<RecordedScene>& recorded_scenes() {
  static std::vector<RecordedScene> scenes;
  return scenes;
}

bool& is_reported() {
  static bool reported = false;
  return reported;
}

}  // namespace

void record_missing_data(const std::filesystem::path& scene_xml) {
  try {
    const PagedScene scene(scene_xml);
    recorded_scenes().push_back({scene_xml, missing_data(scene.header(), scene.totals().cells)});
  } catch (const std::exception&) {
    // The command reads the same file and reports the fault.
  }
}

int report_missing_data(int exit_code) {
  bool any = false;
  for (const RecordedScene& scene : recorded_scenes()) {
    if (!scene.missing.any()) continue;
    any = true;
    if (is_reported()) continue;
    put_output_before_messages();
    const std::string where = recorded_scenes().size() > 1 ? scene.file.string() + ": " : std::string();
    print_message("{}{} (gigabake info lists them)\n", where, describe(scene.missing));
  }
  is_reported() = true;
  return any && exit_code == complete ? cells_failed : exit_code;
}

void silence_missing_data() { is_reported() = true; }

}  // namespace gigabake::app
