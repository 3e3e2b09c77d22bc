/// Textures of cells: in memory, or, those that are large beside the memory there is, mapped from scratch.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <unordered_map>

#include "format/source/mesh.h"
#include "kernels/cpu/texture.h"
#include "lattice/hash128.h"
#include "worker/materials.h"
#include "worker/tiles/texture_file.h"

namespace gigabake {

/// An image and how it is filtered.
struct TextureKey {
  Hash128 image;  ///< of its encoded bytes
  TextureRecipe recipe;
  friend bool operator==(const TextureKey&, const TextureKey&) = default;
};
struct TextureKeyHash {
  std::size_t operator()(const TextureKey& key) const { return std::size_t(key.image.lo) + key.recipe.mask_cutoff; }
};

/// What cells borrow, from wherever.
class CellTexture {
 public:
  explicit CellTexture(kernels::Texture&& held) : held_(std::move(held)) {}
  explicit CellTexture(std::shared_ptr<const TextureFile> file) : file_(std::move(file)) {}
  kernels::TextureView view() const { return held_ ? held_->view() : file_->view(); }
  std::uint64_t bytes() const { return held_ ? held_->bytes() : file_->bytes(); }

 private:
  std::optional<kernels::Texture> held_;
  std::shared_ptr<const TextureFile> file_;
};

class TextureStore {
 public:
  /// folder: none: all are in memory. most_bytes: of a texture that is held in memory.
  TextureStore(std::filesystem::path folder, std::uint64_t most_bytes)
      : folder_(std::move(folder)), most_bytes_(most_bytes) {}

  /// Is a texture of so many bytes mapped from scratch? Else it is in memory.
  bool is_on_scratch(std::uint64_t texture_bytes) const;
  /// texture_bytes: about what it will take. encoded: reads the image, where it must be decoded. A texture that comes
  /// again from scratch has the id that it had. Thread-safe.
  /// Cost    On scratch, of an image that comes in rows (format/source/image/image_rows.h), some rows of memory.
  /// Errors  InputError, as decode_image(). IoError: the scratch folder cannot be written, or is cleared meanwhile.
  std::shared_ptr<const CellTexture> load(const TextureKey& key, std::uint64_t texture_bytes,
                                          const std::function<EncodedImage()>& encoded);

 private:
  enum class WasWritten { before, here };  ///< before: its checksum says whether it is whole
  void write(const std::filesystem::path& file, const EncodedImage& encoded, const TextureRecipe& recipe);
  std::shared_ptr<const CellTexture> stored(const TextureKey& key, const std::filesystem::path& file,
                                            WasWritten by = WasWritten::before);

  const std::filesystem::path folder_;
  const std::uint64_t most_bytes_;
  std::mutex mutex_;
  std::mutex whole_image_;  ///< one at a time is decoded as a whole: each may take what the memory limit allows
  std::unordered_map<TextureKey, std::uint64_t, TextureKeyHash> id_;  ///< of those whose file was looked through
};

}  // namespace gigabake
