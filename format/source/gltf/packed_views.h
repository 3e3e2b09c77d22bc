/// EXT_meshopt_compression: buffer views whose bytes are packed in another buffer, and buffers without bytes that such
/// views refer to.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "format/source/gltf/load.h"
#include "format/source/image/codecs.h"
#include "format/source/source_file.h"

namespace gigabake {

/// A view that must be unpacked because its own buffer has no bytes. A view whose own buffer has bytes is not unpacked.
struct PackedView {
  std::size_t view = 0, buffer = 0;  ///< indices of the view, and of the buffer that has the packed bytes
  std::uint64_t byte_offset = 0, byte_length = 0;
  std::uint64_t byte_stride = 0;  ///< the view's own; 0 if it has none
  MeshoptStream stream;
};

/// Returns whether the buffer has no bytes and only states the length of its unpacked views.
bool is_absent_fallback(const std::filesystem::path& file, const Json& buffer, std::size_t index, bool has_bin);

/// Returns the packed views of a document whose buffers and views are checked.
/// Errors  InputError: a view of a buffer without bytes is not packed, or ranges, strides or lengths violate the
///         extension.
std::vector<PackedView> packed_views(const std::filesystem::path& file, const Json& gltf, bool has_bin);

/// Makes each packed view refer to its packed bytes, so that no view refers to a buffer without bytes.
void refer_to_packed_bytes(const std::vector<PackedView>& packed, tinygltf::Model& model);

/// Appends a buffer with the unpacked bytes of each view, and makes the view refer to it.
/// Errors  InputError like decode_meshopt().
void unpack_views(const std::filesystem::path& file, const std::vector<PackedView>& packed, GltfDocument& document);

}  // namespace gigabake
