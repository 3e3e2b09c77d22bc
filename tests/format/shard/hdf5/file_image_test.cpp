#include "format/shard/hdf5/file_image.h"

#include <fcntl.h>
#include <gtest/gtest.h>

#include "tests/format/shard/made_shard.h"

namespace gigabake {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes bytes_on_disk(const FileImage& image) {
  const made::TempFolder folder;
  EXPECT_TRUE(image.write_to(Descriptor(folder / "file", O_WRONLY | O_CREAT | O_TRUNC)));
  const std::string bytes = made::bytes_of(folder / "file");
  return {bytes.begin(), bytes.end()};
}

TEST(FileImage, KeepsTheLastWriteAndFillsGapsWithZeros) {
  FileImage image;
  const Bytes sevens(6, 7), nines(2, 9);
  image.begin_file();
  image.write(0, sevens.data(), 6, false);
  image.begin_file();
  image.write(8, sevens.data(), 3, true);
  image.write(2, sevens.data(), 4, false);
  image.write(3, nines.data(), 2, false);
  image.set_length(13);
  const Bytes expected{0, 0, 7, 9, 9, 7, 0, 0, 7, 7, 7, 0, 0};
  EXPECT_EQ(bytes_on_disk(image), expected);
  Bytes read(13, 1);
  image.read(0, read.data(), read.size());
  EXPECT_EQ(read, expected);
}

TEST(FileImage, RefersToChunksAndCopiesMetadata) {
  FileImage image;
  Bytes chunk(3, 1), metadata(2, 5);
  image.begin_file();
  image.set_chunk_memory(ChunkMemory::referred);
  image.write(2, chunk.data(), 3, true);
  image.write(0, metadata.data(), 2, false);
  chunk[1] = 8;
  metadata[0] = 6;
  EXPECT_EQ(bytes_on_disk(image), (Bytes{5, 5, 1, 8, 1}));
}

TEST(FileImage, CopiesTheChunksThatTheWriterFrees) {
  FileImage image;
  Bytes kept(2, 1), freed(2, 4);
  image.begin_file();
  image.set_chunk_memory(ChunkMemory::referred);
  image.write(0, kept.data(), 2, true);
  image.set_chunk_memory(ChunkMemory::copied);
  image.write(2, freed.data(), 2, true);
  freed[0] = 9;
  EXPECT_EQ(bytes_on_disk(image), (Bytes{1, 1, 4, 4}));
}

TEST(FileImage, WritesMorePartsThanOneSystemCallTakes) {
  FileImage image;
  image.begin_file();
  image.set_chunk_memory(ChunkMemory::referred);
  Bytes expected;
  for (int i = 0; i < 5000; ++i) expected.push_back(std::uint8_t(i));
  for (std::size_t i = 0; i < expected.size(); ++i) image.write(i, &expected[i], 1, true);
  EXPECT_EQ(bytes_on_disk(image), expected);
}

TEST(FileImage, ReportsADiskThatIsFull) {
  FileImage image;
  image.begin_file();
  const Bytes bytes(10, 3);
  image.write(0, bytes.data(), bytes.size(), false);
  EXPECT_FALSE(image.write_to(Descriptor("/dev/full", O_WRONLY)));
  EXPECT_EQ(errno, ENOSPC);
}

}  // namespace
}  // namespace gigabake
