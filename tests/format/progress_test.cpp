/// Long steps report their progress. They stop wherever a stop is requested and leave no partial file.
#include "core/base/progress.h"

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "format/export/gigavoxels/gigavoxel.h"
#include "format/export/nanovdb/nanovdb.h"
#include "format/export/ply/ply.h"
#include "format/export/voxel_tiles/voxel_tileset.h"
#include "format/scene/check/diff.h"
#include "format/scene/check/verify.h"
#include "format/scene/stored_bytes.h"
#include "format/source/source.h"
#include "tests/format/shard/made_shard.h"

namespace gigabake {
namespace {

using made::TempFolder;
using Path = std::filesystem::path;

/// Stops at the n-th message that it receives.
class Listener : public ProgressListener {
 public:
  explicit Listener(int stop_at = 0) : stop_at_(stop_at) {}
  int heard() const { return heard_; }
  int steps() const { return steps_; }

 private:
  void step(const std::string& name, std::uint64_t total, const std::string&) override {
    EXPECT_FALSE(name.empty());
    ++steps_;
    total_ = total;
    done_ = 0;
  }
  void advance(std::uint64_t parts) override {
    done_ += parts;
    EXPECT_TRUE(total_ == 0 || done_ <= total_) << done_ << " of " << total_;
    if (++heard_ == stop_at_) throw Stopped();
  }

  const int stop_at_;
  std::atomic<int> heard_{0}, steps_{0};
  std::atomic<std::uint64_t> total_{0}, done_{0};
};

struct Work {
  const char* name;
  std::function<void(const Path& folder, const Progress& progress)> run;
};

const Work works[] = {
    {"verify", [](const Path& f, const Progress& p) { verify_scene(f / "scene.xml", 2, p); }},
    {"diff", [](const Path& f, const Progress& p) { diff_scenes(f / "scene.xml", f / "other" / "scene.xml", p); }},
    {"info", [](const Path& f, const Progress& p) { stored_bytes(PagedScene(f / "scene.xml"), p); }},
    {"ply", [](const Path& f, const Progress& p) { export_ply(f / "scene.xml", 0, f / "out" / "v", p); }},
    {"nvdb", [](const Path& f, const Progress& p) { export_nanovdb(f / "scene.xml", 0, f / "out" / "v", p); }},
    {"3dtiles", [](const Path& f, const Progress& p) { export_3dtiles(f / "scene.xml", {}, f / "out" / "v", p); }},
    {"gigavoxel",
     [](const Path& f, const Progress& p) {
       export_gigavoxel(f / "scene.xml", 0, f / "out" / "v", GigavoxelTreeFile::binary, p);
     }},
    {"tileset", [](const Path& f, const Progress& p) { open_sources(f / "tileset.json", {}, p); }},
    {"folder", [](const Path& f, const Progress& p) { open_sources(f / "tiles", {}, p); }},
};

void write_sources(const Path& folder) {
  std::filesystem::create_directories(folder / "tiles");
  std::string children;
  for (const char* name : {"tiles/a.glb", "tiles/b.glb", "tiles/a.glb"}) {
    std::ofstream(folder / name) << "glTF";
    children += (children.empty() ? "" : ",") +
                (R"({"boundingVolume":{"sphere":[0,0,0,1]},"geometricError":0,"content":{"uri":")" + std::string(name) +
                 R"("}})");
  }
  std::ofstream(folder / "tileset.json")
      << R"({"asset":{"version":"1.0"},"geometricError":1,"root":{"boundingVolume":{"sphere":[0,0,0,1]},)"
      << R"("geometricError":1,"refine":"ADD","children":[)" << children << "]}}";
}

TEST(Progress, IsToldAndStopsEveryLongStepWithoutAnythingHalfWritten) {
  const TempFolder folder;
  std::filesystem::create_directories(folder / "other");
  made::write_scene_of(folder / "scene.xml", {made::shard_of({{{1, 2, 3}, {1, 2, 3, 255}, {1, 0}}}, {0, 0, 0}, 16),
                                              made::shard_of({{{17, 2, 3}, {1, 2, 3, 255}, {1, 0}}}, {16, 0, 0}, 16)});
  made::write_scene_of(folder.path() / "other" / "scene.xml",
                       {made::shard_of({{{1, 2, 3}, {9, 2, 3, 255}, {1, 0}}}, {0, 0, 0}, 16)});
  write_sources(folder.path());
  for (const Work& work : works) {
    Listener all;
    std::filesystem::create_directories(folder / "out");
    ASSERT_NO_THROW(work.run(folder.path(), Progress(all))) << work.name;
    EXPECT_GT(all.heard(), all.steps()) << work.name;
    EXPECT_GE(all.steps(), 1) << work.name;
    for (int stop_at = 1; stop_at <= all.heard(); stop_at += std::max(1, all.heard() / 20)) {
      std::filesystem::remove_all(folder / "out");
      std::filesystem::create_directories(folder / "out");
      Listener listener(stop_at);
      EXPECT_THROW(work.run(folder.path(), Progress(listener)), Stopped) << work.name << " at " << stop_at;
      EXPECT_TRUE(std::filesystem::is_empty(folder / "out")) << work.name << " at " << stop_at;
    }
  }
}

// 2026-11-25: this test did not assert anything.
TEST(Progress, WithoutAListenerStopsNothingAndIsAsSmallAsAPointer) {
  const Progress nobody;
  int done = 0;
  EXPECT_NO_THROW({
    nobody.step("anything", 3);
    for (; done < 10; ++done) nobody.advance();  // more parts than were announced
    nobody.advance(0);
  });
  EXPECT_EQ(done, 10);
  EXPECT_EQ(sizeof(Progress), sizeof(void*)) << "a copy without a listener holds a null pointer and nothing else";
  // If there is a listener, the first call reaches the listener, which stops it.
  Listener stopping(1);
  EXPECT_THROW(Progress(stopping).step("anything", 3), Stopped);
  EXPECT_EQ(stopping.steps(), 1);
}

}  // namespace
}  // namespace gigabake
