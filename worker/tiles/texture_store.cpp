#include "worker/tiles/texture_store.h"

#include <algorithm>
#include <utility>

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "core/base/thread_pool.h"
#include "format/source/image/image_rows.h"
#include "worker/tiles/scratch_publication.h"
#include "worker/tiles/texture_rows.h"

namespace gigabake {
namespace {

/// Decodes and filters on the calling thread, because several textures are loaded concurrently.
kernels::Texture make_texture(const EncodedImage& encoded, const TextureFilterKey& filter_key) {
  Image image = decode_image(encoded);
  return {std::move(image.rgba),  image.width,      image.height,      filter_key.alpha,
          filter_key.mask_cutoff, callers_thread(), filter_key.content};
}

/// Bytes of memory per pixel of the image's width if the image is decoded in rows: three rows of each level, and the
/// decoder's buffers.
constexpr std::uint64_t bytes_of_rows = 64;

std::string file_name(const TextureKey& key) {
  const bool is_colours = key.filter_key.content == kernels::TextureContent::colours;
  return "x_" + key.image.hex() + "_" + std::to_string(int(key.filter_key.alpha)) + "_" +
         std::to_string(int(key.filter_key.mask_cutoff)) + (is_colours ? "" : "_normals") + ".texture";
}

}  // namespace

std::shared_ptr<const CellTexture> TextureStore::load(const TextureKey& key, std::uint64_t texture_bytes,
                                                      const std::function<EncodedImage()>& encoded) {
  if (!is_on_scratch(texture_bytes))
    return std::make_shared<const CellTexture>(make_texture(encoded(), key.filter_key));
  const std::filesystem::path file = folder_ / file_name(key);
  return find_or_make(
      file, [&] { return stored(key, file); },
      [&] {
        write(file, encoded(), key.filter_key);
        if (auto found = stored(key, file, WasWritten::here)) return found;
        throw IoError(file, "", "is missing, although it was just written; does another bake clear the folder?");
      });
}

/// Writes the texture row by row if the image format allows it; otherwise the decoded image must fit into memory.
void TextureStore::write(const std::filesystem::path& file, const EncodedImage& encoded,
                         const TextureFilterKey& filter_key) {
  const auto rows = ImageRows::open(encoded);
  if (rows == nullptr) {
    const std::scoped_lock lock(whole_image_);
    return write_texture(file, make_texture(encoded, filter_key).view());
  }
  MemoryClaim(encoded.name, "make it smaller").add(rows->size().width * bytes_of_rows, "", "rows of the image");
  write_texture_rows(file, *rows, filter_key);
}

bool TextureStore::is_on_scratch(std::uint64_t texture_bytes) const {
  return !folder_.empty() && texture_bytes > std::min(max_bytes_, ImageSize::texture_bytes_of(max_whole_image_texels));
}

std::shared_ptr<const CellTexture> TextureStore::stored(const TextureKey& key, const std::filesystem::path& file,
                                                        WasWritten by) {
  std::optional<std::uint64_t> known;
  {
    const std::scoped_lock lock(mutex_);
    if (const auto found = id_.find(key); found != id_.end()) known = found->second;
  }
  const std::uint64_t id = known ? *known : kernels::new_texture_id();
  auto texture = TextureFile::open(file, id, known.has_value() || by == WasWritten::here);
  if (texture == nullptr) return nullptr;
  const std::scoped_lock lock(mutex_);
  id_.emplace(key, id);
  return std::make_shared<const CellTexture>(std::move(texture));
}

}  // namespace gigabake
