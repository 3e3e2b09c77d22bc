#include "worker/tiles/texture_file.h"

#include <algorithm>
#include <cstring>
#include <sys/mman.h>
#include <sys/stat.h>
#include <vector>
#define XXH_STATIC_LINKING_ONLY
#define XXH_INLINE_ALL
#include <xxhash.h>

#include "core/base/error.h"
#include "format/source/image/image_size.h"
#include "format/system/descriptor.h"
#include "worker/tiles/mapped_textures.h"
#include "worker/tiles/scratch_publication.h"
#include "worker/tiles/texture_layout.h"

namespace gigabake {
namespace {

bool is_sensible(const TextureHead& head, std::uint64_t file_bytes) {
  return head.magic == TextureHead::right_magic && head.version == texture_file_version && head.width > 0 &&
         head.height > 0 && std::uint64_t(head.width) * std::uint64_t(head.height) <= max_texels && head.levels > 0 &&
         head.levels <= kernels::max_texture_levels && head.mask_cutoff < 256 && head.is_opaque <= 1 &&
         head.bytes == head.bytes_before(head.levels) && file_bytes == sizeof head + head.bytes;
}

/// Hashes mapped bytes and releases their pages immediately: only texels that cells use should count as this process's
/// memory.
std::uint64_t hash_and_release(const std::uint8_t* begin, std::uint64_t bytes) {
  constexpr std::uint64_t at_once = std::uint64_t(16) << 20, page = 4096;
  XXH3_state_t state;
  XXH3_64bits_reset(&state);
  for (std::uint64_t at = 0; at < bytes; at += at_once) {
    const std::uint64_t part = std::min(at_once, bytes - at);
    XXH3_64bits_update(&state, begin + at, part);
    const auto first = reinterpret_cast<std::uintptr_t>(begin + at) / page * page;
    ::madvise(reinterpret_cast<void*>(first), reinterpret_cast<std::uintptr_t>(begin + at + part) - first,
              MADV_DONTNEED);
  }
  return XXH3_64bits_digest(&state);
}

/// Returns the checksum of header and levels. `level_hash` returns the hash of a level.
template <class LevelHash>
std::uint64_t checksum_of_levels(const TextureHead& head, const LevelHash& level_hash) {
  std::vector<std::uint64_t> hashes;
  for (int l = 0; l < head.levels; ++l) hashes.push_back(level_hash(l));
  return checksum_of(head, hashes);
}

}  // namespace

std::uint64_t checksum_of(TextureHead head, std::span<const std::uint64_t> level_hashes) {
  head.checksum = 0;
  XXH3_state_t state;
  XXH3_64bits_reset(&state);
  XXH3_64bits_update(&state, &head, sizeof head);
  XXH3_64bits_update(&state, level_hashes.data(), level_hashes.size_bytes());
  return XXH3_64bits_digest(&state);
}

void write_texture(const std::filesystem::path& target, const kernels::TextureView& texture) {
  TextureHead head;
  head.width = texture.width, head.height = texture.height, head.levels = texture.levels;
  head.mask_cutoff = texture.mask_cutoff;
  head.is_opaque = texture.is_opaque;
  head.bytes = head.bytes_before(head.levels);
  const auto level_at = [&](int l) {
    return l == 0 ? texture.base : reinterpret_cast<const std::uint8_t*>(texture.level[l]);
  };
  head.checksum = checksum_of_levels(head, [&](int l) { return XXH3_64bits(level_at(l), head.level_bytes(l)); });
  ScratchPublication file(target);
  file.append({reinterpret_cast<const std::uint8_t*>(&head), sizeof head});
  for (int l = 0; l < head.levels; ++l) file.append({level_at(l), head.level_bytes(l)});
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
  const auto level_at = [&](int l) { return texels + head.bytes_before(l); };
  const auto level_hash = [&](int l) { return hash_and_release(level_at(l), head.level_bytes(l)); };
  if (!is_checked && checksum_of_levels(head, level_hash) != head.checksum) return nullptr;
  kernels::TextureView& v = texture->view_;
  v.base = texels;
  for (int l = 1; l < head.levels; ++l) v.level[l] = reinterpret_cast<const std::uint16_t*>(level_at(l));
  v.width = head.width, v.height = head.height, v.levels = head.levels;
  v.mask_cutoff = std::uint8_t(head.mask_cutoff);
  v.is_opaque = head.is_opaque != 0;
  v.id = id;
  return texture;
}

TextureFile::TextureFile(void* begin, std::uint64_t bytes) : begin_(begin), bytes_(bytes) {
  MappedTextures::of_process().add(begin_, bytes_);
}

TextureFile::~TextureFile() {
  MappedTextures::of_process().remove(begin_);
  ::munmap(begin_, bytes_);
}

}  // namespace gigabake
