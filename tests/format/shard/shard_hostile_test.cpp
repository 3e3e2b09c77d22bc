#include <gtest/gtest.h>
#include <random>

#include "core/base/error.h"
#include "damaged_file.h"
#include "format/shard/shard.h"
#include "made_shard.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

using made::TempFolder;

/// Expects an error or exactly the shard that was written.
void expect_error_or_equal(const std::filesystem::path& path, const Shard& written, const std::string& what) {
  try {
    EXPECT_EQ(made::difference(written, read_shard(path)), "") << what;
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << what << ": " << error.what();
  }
}

TEST(HostileShard, WithAnyByteChangedIsAnErrorOrReadsAsBefore) {
  const TempFolder folder;
  const Shard shard = made::small_shard();
  write_shard(folder / "s.h5", shard, {});
  made::for_each_changed_byte(folder / "s.h5", test::RandomSeed(),
                              [&](const std::string& what) { expect_error_or_equal(folder / "s.h5", shard, what); });
}

TEST(HostileShard, WithAnOverwrittenStretchIsAnErrorOrReadsAsBefore) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const TempFolder folder;
  const Shard shard = made::with_classes(made::random_shard(rng, {3, true, 3, rng() % 2 == 0}));
  write_shard(folder / "s.h5", shard, {});
  made::for_each_overwritten_stretch(
      folder / "s.h5", seed, [&](const std::string& what) { expect_error_or_equal(folder / "s.h5", shard, what); });
}

TEST(HostileShard, CutAnywhereIsAnError) {
  const TempFolder folder;
  write_shard(folder / "s.h5", made::small_shard(), {});
  made::for_each_cut(folder / "s.h5",
                     [&](const std::string& what) { EXPECT_THROW(read_shard(folder / "s.h5"), InputError) << what; });
}

}  // namespace
}  // namespace gigabake
