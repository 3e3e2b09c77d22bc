#include "app/process/clipped_scene.h"

#include "app/messages/with_progress.h"
#include "cluster/clip/clip_scene.h"
#include "format/system/host_limits.h"

namespace gigabake::app {

ClippedScene::ClippedScene(const std::filesystem::path& scene_xml, const AreaOptions& options, int threads,
                           bool shows_progress)
    : file_(scene_xml) {
  const std::shared_ptr<const Area> area = options.area();
  if (!area) return;
  folder_.emplace();
  file_ = with_progress(
      [&](const Progress& progress) {
        return clip_scene(scene_xml, area, folder_->path(), threads > 0 ? threads : host_limits().cores(), progress);
      },
      shows_progress ? stderr : nullptr);
}

}  // namespace gigabake::app
