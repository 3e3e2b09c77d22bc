/// EXT_meshopt_compression: buffer views whose bytes are packed in another buffer, and the buffers without bytes that
/// they pretend to be in.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "format/source/gltf/load.h"
#include "format/source/image/codecs.h"
#include "format/source/source_file.h"

namespace gigabake {

/// A view that must be unpacked: its own buffer has no bytes. Where it has, these are read, and the packed ones not.
struct PackedView {
  std::size_t view = 0, buffer = 0;  ///< of the document
  std::uint64_t byte_offset = 0, byte_length = 0;
  std::uint64_t byte_stride = 0;  ///< the view's own; 0 where it has none
  MeshoptStream stream;
};

/// Does the buffer only say how long its views are, once unpacked?
bool is_absent_fallback(const std::filesystem::path& file, const Json& buffer, std::size_t index, bool has_bin);

/// Of a document whose buffers and views are checked. Errors  InputError: a view of an absent fallback that is not
/// packed, ranges, strides and lengths that are not as the extension has them.
std::vector<PackedView> packed_views(const std::filesystem::path& file, const Json& gltf, bool has_bin);

/// The document with views where their packed bytes are, and with a byte in place of each absent fallback.
Json without_packed_views(Json gltf, const std::vector<PackedView>& packed);

/// Appends a buffer for each view, and puts the view there. Errors  InputError as decode_meshopt().
void unpack_views(const std::filesystem::path& file, const std::vector<PackedView>& packed, GltfDocument& document);

}  // namespace gigabake
