#include <cstring>

#include "kernels/cuda/device/stream.cuh"
#include "kernels/marching/scene.h"
#include "kernels/render/device_page_pool.cuh"

namespace gigabake::kernels {
namespace {

constexpr std::size_t word_bytes = sizeof(std::uint32_t), column_count = 4;
/// The max number of words of one upload, unless a single page is larger. It bounds the page-locked memory.
constexpr std::size_t upload_words = std::size_t(1) << 20;
constexpr std::uint32_t words_per_block = 4096;
constexpr unsigned copy_threads = 256;

/// A copy of words of an upload to a column.
struct WordCopy {
  std::uint32_t from, to, count, column;
};

struct ColumnWords {
  std::uint32_t* column[column_count];
};

/// Copies parts of an upload to the columns. Each block of threads does one copy.
__global__ void scatter_columns(const WordCopy* copies, const std::uint32_t* words, ColumnWords columns) {
  const WordCopy copy = copies[blockIdx.x];
  std::uint32_t* const to = columns.column[copy.column] + copy.to;
  for (std::uint32_t i = threadIdx.x; i < copy.count; i += blockDim.x) to[i] = words[copy.from + i];
}

/// A column of a page.
struct PageColumn {
  const void* bytes;
  std::size_t bytes_per_voxel;
};

std::array<PageColumn, column_count> columns_of(const StoredVoxels& voxels) {
  return {{{voxels.rgba, 4},
           {voxels.normal, 2},
           {voxels.directional_coverage, directional_coverage_bytes},
           {voxels.voxel_class, sizeof(VoxelClass)}}};
}

std::size_t words_of(std::size_t bytes) { return (bytes + word_bytes - 1) / word_bytes; }

std::size_t words_of(const PageUpload& page) {
  std::size_t words = 0;
  for (const PageColumn& column : columns_of(page.voxels))
    if (column.bytes != nullptr) words += words_of(column.bytes_per_voxel * page.count);
  return words;
}

/// A part of a column of a page, and the number of its bytes: the last word of a column may be incomplete.
struct ColumnPart {
  const std::byte* bytes;
  std::size_t byte_count;
};

}  // namespace

DevicePagePool::DevicePagePool(DeviceHeap& heap, UploadRing& uploads, const ThreadPool& pool, const PagePoolSize& size,
                               const Tables& tables)
    : heap_(heap), uploads_(uploads), pool_(pool), shading_(size.shading) {
  if (size.voxels == 0) return;
  const bool exists[column_count] = {true, size.has_normals, size.has_directional_coverage, size.has_classes};
  for (std::size_t c = 0; c < column_count; ++c)
    if (exists[c])
      columns_[c] = DeviceArray<std::uint32_t>(heap, words_of(columns_of({})[c].bytes_per_voxel * size.voxels));
  coverage_ = uploaded(heap, size.shading.coverage, std::size_t(max_cast_lods) * 256);
  class_colour_ = uploaded(heap, size.shading.class_colour, 3 * (1 + class_colour_count));
  shading_.coverage = coverage_.data();
  shading_.class_colour = class_colour_.data();
  shading_.tables = tables;
}

StoredVoxels DevicePagePool::voxels() const {
  return {reinterpret_cast<const std::uint8_t*>(columns_[0].data()),
          reinterpret_cast<const std::int8_t*>(columns_[1].data()),
          reinterpret_cast<const std::uint8_t*>(columns_[2].data()),
          reinterpret_cast<const VoxelClass*>(columns_[3].data())};
}

void DevicePagePool::put(const std::vector<PageUpload>& pages) {
  for (std::size_t begin = 0, end = 0; begin < pages.size(); begin = end) {
    std::size_t words = 0;
    while (end < pages.size() && (end == begin || words + words_of(pages[end]) <= upload_words))
      words += words_of(pages[end++]);
    put_some(std::span(pages).subspan(begin, end - begin), words);
  }
}

/// Uploads pages of `words` words in one buffer, and copies their columns from it.
void DevicePagePool::put_some(std::span<const PageUpload> pages, std::size_t words) {
  std::vector<ColumnPart> parts;
  std::vector<WordCopy> copies;  ///< one per part
  std::size_t at = 0;
  for (const PageUpload& page : pages) {
    const std::array<PageColumn, column_count> columns = columns_of(page.voxels);
    for (std::uint32_t c = 0; c < column_count; ++c) {
      if (columns[c].bytes == nullptr || columns_[c].empty()) continue;
      const std::size_t bytes = columns[c].bytes_per_voxel * page.count;
      const std::size_t to = columns[c].bytes_per_voxel * page.place.first / word_bytes;
      for (std::uint32_t i = 0; i < words_of(bytes); i += words_per_block) {
        const std::uint32_t count = std::min(words_per_block, std::uint32_t(words_of(bytes)) - i);
        copies.push_back({std::uint32_t(at) + i, std::uint32_t(to) + i, count, c});
        parts.push_back({static_cast<const std::byte*>(columns[c].bytes) + word_bytes * i,
                         std::min(word_bytes * count, bytes - word_bytes * i)});
      }
      at += words_of(bytes);
    }
  }
  if (copies.empty()) return;
  const std::size_t copy_bytes = copies.size() * sizeof(WordCopy);
  std::byte* const buffer = uploads_.reserve(copy_bytes + words * word_bytes);
  std::memcpy(buffer, copies.data(), copy_bytes);
  pool_.parallel_for(parts.size(), 4, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i)
      std::memcpy(buffer + copy_bytes + word_bytes * copies[i].from, parts[i].bytes, parts[i].byte_count);
  });
  const std::byte* const sent = uploads_.send();
  ColumnWords targets{};
  for (std::size_t c = 0; c < column_count; ++c) targets.column[c] = columns_[c].data();
  scatter_columns<<<unsigned(copies.size()), copy_threads, 0, heap_.stream()>>>(
      reinterpret_cast<const WordCopy*>(sent), reinterpret_cast<const std::uint32_t*>(sent + copy_bytes), targets);
  check_launch("scatter_columns");
}

}  // namespace gigabake::kernels
