/// A texture's pyramid on scratch, mapped into memory: decoded and filtered once, then cells touch the texels that they
/// show, and all ranks of a host share what the system keeps of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "kernels/body/texture_view.h"

namespace gigabake {

/// Raised whenever the same image would make another pyramid, or one would be stored otherwise.
inline constexpr std::uint32_t texture_file_version = 2;

/// Appears whole or not at all. Errors  IoError: the file and the system's reason.
void write_texture(const std::filesystem::path& target, const kernels::TextureView& texture);

class TextureFile {
 public:
  /// Null where there is no whole file of this version. id: TextureView::id of the result.
  /// Cost  Reads all of it, for its checksum, where is_checked is false.
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
