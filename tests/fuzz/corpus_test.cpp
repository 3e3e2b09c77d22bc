// The fuzzers' seeds and findings: each file is read successfully or refused in one clear line. tests/fuzz/run.py runs
// the fuzzers.
#include <filesystem>
#include <gtest/gtest.h>
#include <ostream>

#include "format/system/read_file.h"
#include "tests/fuzz/judge.h"

namespace gigabake::fuzz {
namespace {

struct Named {
  const char* name;
  Reader reader;
  friend std::ostream& operator<<(std::ostream& out, const Named& n) { return out << n.name; }
};

class Corpus : public testing::TestWithParam<Named> {};

TEST_P(Corpus, EndsInSuccessOrInOneClearLine) {
  const std::filesystem::path folder = GIGABAKE_SOURCE_DIR "/tests/fuzz/corpus";
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / GetParam().name)) {
    SCOPED_TRACE(entry.path().filename());
    EXPECT_EQ(fault_of(GetParam().reader, read_whole_file(entry.path())), "");
    ++files;
  }
  EXPECT_GT(files, 0);
}

#define GIGABAKE_NAMED(reader) \
  Named { #reader, reader }
INSTANTIATE_TEST_SUITE_P(
    Fuzz, Corpus,
    testing::Values(GIGABAKE_NAMED(gltf), GIGABAKE_NAMED(tile), GIGABAKE_NAMED(tileset), GIGABAKE_NAMED(subtree),
                    GIGABAKE_NAMED(archive), GIGABAKE_NAMED(scene_json), GIGABAKE_NAMED(obj), GIGABAKE_NAMED(ply),
                    GIGABAKE_NAMED(stl), GIGABAKE_NAMED(raster), GIGABAKE_NAMED(orthophoto), GIGABAKE_NAMED(image),
                    GIGABAKE_NAMED(geojson), GIGABAKE_NAMED(shard), GIGABAKE_NAMED(scene_xml),
                    GIGABAKE_NAMED(gigavoxel_list), GIGABAKE_NAMED(gigavoxel_tree), GIGABAKE_NAMED(journal),
                    GIGABAKE_NAMED(scan_cache), GIGABAKE_NAMED(bake_status), GIGABAKE_NAMED(bake_messages),
                    GIGABAKE_NAMED(camera_path), GIGABAKE_NAMED(steering), GIGABAKE_NAMED(http_head)),
    [](const auto& named) { return std::string(named.param.name); });
#undef GIGABAKE_NAMED

}  // namespace
}  // namespace gigabake::fuzz
