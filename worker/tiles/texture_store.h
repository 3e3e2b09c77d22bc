/// Textures of cells. Small textures are in memory; textures above a size limit are mapped from scratch.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <unordered_map>

#include "core/io/hash128.h"
#include "format/source/mesh.h"
#include "kernels/cpu/texture/texture.h"
#include "worker/pipeline/materials.h"
#include "worker/tiles/texture_file.h"

namespace gigabake {

/// Key of a texture: an image and its filtering.
struct TextureKey {
  Hash128 image;  ///< hash of the encoded bytes
  TextureFilterKey filter_key;
  friend bool operator==(const TextureKey&, const TextureKey&) = default;
};
struct TextureKeyHash {
  std::size_t operator()(const TextureKey& key) const {
    return std::size_t(key.image.lo) + key.filter_key.mask_cutoff + 256 * std::size_t(key.filter_key.content);
  }
};

/// A texture that cells share, in memory or mapped from scratch.
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
  /// Creates a store. If `folder` is empty, all textures are held in memory. Otherwise large textures, at least those
  /// above `max_bytes`, are mapped from files in `folder`.
  TextureStore(std::filesystem::path folder, std::uint64_t max_bytes)
      : folder_(std::move(folder)), max_bytes_(max_bytes) {}

  /// Returns true if a texture of this size is mapped from scratch, false if it is held in memory.
  bool is_on_scratch(std::uint64_t texture_bytes) const;
  /// Returns the texture; makes it if needed. Thread-safe. `texture_bytes` is the approximate size of the texture.
  /// `encoded` reads the image; it is called only if the image must be decoded. A texture that is reopened from scratch
  /// keeps its id.
  /// Cost    A texture on scratch needs memory for only a few rows if its image format can be decoded in rows
  ///         (format/source/image/image_rows.h).
  /// Errors  The errors of decode_image(). IoError: the scratch folder cannot be written, or another process clears it
  ///         during the call.
  std::shared_ptr<const CellTexture> load(const TextureKey& key, std::uint64_t texture_bytes,
                                          const std::function<EncodedImage()>& encoded);

 private:
  enum class WasWritten { before, here };  ///< before: the checksum must be verified
  void write(const std::filesystem::path& file, const EncodedImage& encoded, const TextureFilterKey& filter_key);
  std::shared_ptr<const CellTexture> stored(const TextureKey& key, const std::filesystem::path& file,
                                            WasWritten by = WasWritten::before);

  const std::filesystem::path folder_;
  const std::uint64_t max_bytes_;
  std::mutex mutex_;
  std::mutex whole_image_;  ///< serializes full decodes: each may use all of the memory limit
  std::unordered_map<TextureKey, std::uint64_t, TextureKeyHash> id_;  ///< ids of textures whose file has been verified
};

}  // namespace gigabake
