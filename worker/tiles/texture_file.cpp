#include "worker/tiles/texture_file.h"

#include <cerrno>
#include <cstring>
#include <sys/mman.h>
#include <sys/stat.h>
#define XXH_STATIC_LINKING_ONLY
#define XXH_INLINE_ALL
#include <xxhash.h>

#include "format/system/descriptor.h"
#include "format/system/io_error.h"
#include "worker/tiles/scratch_publication.h"

namespace gigabake {
namespace {

constexpr std::uint64_t texture_magic = 0x7865747462676267;  // "gbgbttex"

struct TextureHead {
  std::uint64_t magic = texture_magic, bytes = 0, checksum = 0;
  std::uint32_t version = texture_file_version;
  std::int32_t width = 0, height = 0, levels = 0;
  std::uint32_t mask_cutoff = 0, unused[3] = {};
};
static_assert(sizeof(TextureHead) == 56 && sizeof(TextureHead) % alignof(std::uint16_t) == 0);

std::uint64_t bytes_of_level(const TextureHead& head, int level) {
  return std::uint64_t(kernels::level_extent(head.width, level)) *
         std::uint64_t(kernels::level_extent(head.height, level)) * (level == 0 ? 4 : 8);
}

std::uint64_t bytes_of_levels(const TextureHead& head) {
  std::uint64_t bytes = 0;
  for (int l = 0; l < head.levels; ++l) bytes += bytes_of_level(head, l);
  return bytes;
}

bool is_sensible(const TextureHead& head, std::uint64_t file_bytes) {
  constexpr std::int64_t most_texels = std::int64_t(1) << 28;
  return head.magic == texture_magic && head.version == texture_file_version && head.width > 0 && head.height > 0 &&
         std::int64_t(head.width) * head.height <= most_texels && head.levels > 0 &&
         head.levels <= kernels::max_texture_levels && head.mask_cutoff < 256 && head.bytes == bytes_of_levels(head) &&
         file_bytes == sizeof head + head.bytes;
}

/// Of the head without its checksum, and of all levels. levels: gives the bytes of one.
template <class Levels>
std::uint64_t checksum_of(TextureHead head, const Levels& levels) {
  head.checksum = 0;
  XXH3_state_t state;
  XXH3_64bits_reset(&state);
  XXH3_64bits_update(&state, &head, sizeof head);
  for (int l = 0; l < head.levels; ++l) XXH3_64bits_update(&state, levels(l).data(), levels(l).size());
  return XXH3_64bits_digest(&state);
}

}  // namespace

void write_texture(const std::filesystem::path& target, const kernels::TextureView& texture) {
  TextureHead head;
  head.width = texture.width, head.height = texture.height, head.levels = texture.levels;
  head.mask_cutoff = texture.mask_cutoff;
  head.bytes = bytes_of_levels(head);
  const auto level = [&](int l) {
    const void* texels = l == 0 ? static_cast<const void*>(texture.base) : texture.level[l];
    return std::span(static_cast<const std::uint8_t*>(texels), bytes_of_level(head, l));
  };
  head.checksum = checksum_of(head, level);
  ScratchPublication file(target);
  file.append({reinterpret_cast<const std::uint8_t*>(&head), sizeof head});
  for (int l = 0; l < head.levels; ++l) file.append(level(l));
  file.publish();
}

std::shared_ptr<const TextureFile> TextureFile::open(const std::filesystem::path& path, std::uint64_t id,
                                                     bool is_checked) {
  const Descriptor file(path, O_RDONLY);
  struct stat found {};
  if (!file.is_open() || ::fstat(file.get(), &found) != 0 || std::uint64_t(found.st_size) < sizeof(TextureHead))
    return nullptr;
  const std::uint64_t size = std::uint64_t(found.st_size);
  void* begin = ::mmap(nullptr, size, PROT_READ, MAP_SHARED, file.get(), 0);
  if (begin == MAP_FAILED) return nullptr;
  const std::shared_ptr<TextureFile> texture(new TextureFile(begin, size));
  TextureHead head;
  std::memcpy(&head, begin, sizeof head);
  if (!is_sensible(head, size)) return nullptr;
  const auto* texels = static_cast<const std::uint8_t*>(begin) + sizeof head;
  const auto all_levels = [&](int l) { return std::span(texels, l == 0 ? head.bytes : 0); };
  if (!is_checked && checksum_of(head, all_levels) != head.checksum) return nullptr;
  // Only the texels that cells show are to count as this process's memory.
  if (!is_checked) ::madvise(begin, size, MADV_DONTNEED);
  kernels::TextureView& v = texture->view_;
  v.base = texels;
  for (int l = 1; l < head.levels; ++l) {
    texels += bytes_of_level(head, l - 1);
    v.level[l] = reinterpret_cast<const std::uint16_t*>(texels);
  }
  v.width = head.width, v.height = head.height, v.levels = head.levels;
  v.mask_cutoff = std::uint8_t(head.mask_cutoff);
  v.id = id;
  return texture;
}

TextureFile::~TextureFile() { ::munmap(begin_, bytes_); }

}  // namespace gigabake
