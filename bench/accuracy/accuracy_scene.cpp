#include "bench/accuracy/accuracy_scene.h"

namespace gigabake::bench {

AccuracyScene::AccuracyScene(const AccuracyBenchRequest& request, const AccuracyProgress& progress)
    : sources(open_sources(request.scene.source, request.scene.source_options, request.scene.progress)),
      caster(sources, request.scene.parameters, request.scene.threads) {
  renderer.threads = request.scene.threads;
  progress("bake");
  std::filesystem::remove_all(request.out / "shards");
  bake_scene(sources, request.scene, choose_device({request.backend}).device, request.out);
}

}  // namespace gigabake::bench
