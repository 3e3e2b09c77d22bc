/// A texture's pyramid on scratch, mapped into memory. The image is decoded and filtered once. Cells then page in only
/// the texels that they use, and all ranks of a host share the page cache.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "kernels/body/texture/texture_view.h"

namespace gigabake {

/// Version of the file. Increment it when the same image would give another pyramid, or when the file layout changes.
inline constexpr std::uint32_t texture_file_version = 3;

/// Writes a texture's scratch file atomically.
/// Errors  IoError with the file and the system's reason.
void write_texture(const std::filesystem::path& target, const kernels::TextureView& texture);

class TextureFile {
 public:
  /// Maps a texture file; returns null if there is no complete file of this version. `id` becomes TextureView::id of
  /// the result.
  /// Cost    Reads the whole file for its checksum if is_checked is false.
  static std::shared_ptr<const TextureFile> open(const std::filesystem::path& path, std::uint64_t id, bool is_checked);
  ~TextureFile();
  TextureFile(const TextureFile&) = delete;
  TextureFile& operator=(const TextureFile&) = delete;

  const kernels::TextureView& view() const { return view_; }
  std::uint64_t bytes() const { return bytes_; }

 private:
  TextureFile(void* begin, std::uint64_t bytes);

  void* begin_;
  std::uint64_t bytes_;
  kernels::TextureView view_;
};

}  // namespace gigabake
