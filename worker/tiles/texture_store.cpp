#include "worker/tiles/texture_store.h"

#include <utility>

#include "lattice/thread_pool.h"
#include "worker/tiles/scratch_publication.h"

namespace gigabake {
namespace {

/// Filtering needs no threads of its own: textures are loaded side by side.
kernels::Texture make_texture(const EncodedImage& encoded, const TextureRecipe& recipe) {
  Image image = decode_image(encoded);
  return {std::move(image.rgba), image.width, image.height, recipe.alpha, recipe.mask_cutoff, callers_thread()};
}

std::string file_name(const TextureKey& key) {
  return "x_" + key.image.hex() + "_" + std::to_string(int(key.recipe.alpha)) + "_" +
         std::to_string(int(key.recipe.mask_cutoff)) + ".texture";
}

}  // namespace

std::shared_ptr<const CellTexture> TextureStore::load(const TextureKey& key, std::uint64_t texture_bytes,
                                                      const std::function<EncodedImage()>& encoded) {
  const auto decoded = [&] { return make_texture(encoded(), key.recipe); };
  if (folder_.empty() || texture_bytes <= most_bytes_) return std::make_shared<const CellTexture>(decoded());
  const std::filesystem::path file = folder_ / file_name(key);
  if (auto found = stored(key, file)) return found;
  make_scratch_folder(folder_);
  const ScratchTurn turn(file);
  if (auto found = stored(key, file)) return found;
  kernels::Texture texture = decoded();
  write_texture(file, texture.view());
  if (auto found = stored(key, file)) return found;
  return std::make_shared<const CellTexture>(std::move(texture));  // somebody clears the folder
}

std::shared_ptr<const CellTexture> TextureStore::stored(const TextureKey& key, const std::filesystem::path& file) {
  std::optional<std::uint64_t> known;
  {
    const std::scoped_lock lock(mutex_);
    if (const auto found = id_.find(key); found != id_.end()) known = found->second;
  }
  const std::uint64_t id = known ? *known : kernels::new_texture_id();
  auto texture = TextureFile::open(file, id, known.has_value());
  if (texture == nullptr) return nullptr;
  const std::scoped_lock lock(mutex_);
  id_.emplace(key, id);
  return std::make_shared<const CellTexture>(std::move(texture));
}

}  // namespace gigabake
