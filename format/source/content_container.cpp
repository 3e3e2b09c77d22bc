#include "format/source/content_container.h"

#include <cmath>
#include <string_view>

#include "format/source/content_magic.h"
#include "format/source/gltf/version.h"
#include "format/source/tiles/b3dm_layout.h"
#include "format/source/tiles/feature_table.h"
#include "format/source/tiles/i3dm_instances.h"
#include "lattice/byte_cursor.h"

namespace gigabake {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::uint32_t json_chunk = 0x4e4f534a, bin_chunk = 0x004e4942;

/// Source  glTF 2.0, "GLB File Format Specification".
void open_glb(const std::filesystem::path& file, ContentContainer& out) {
  ByteCursor in{file, out.model_uri.empty() ? Bytes(out.file) : Bytes(out.model), out.gltf};
  in.word("the GLB header");
  const std::uint32_t version = in.word("the GLB header");
  if (version == 1) refuse_gltf_1(file);
  if (version != 2) in.fail("expected GLB version 2, got " + std::to_string(version));
  const std::uint32_t length = in.word("the GLB header");
  if (length < 12 || length > out.gltf.size())
    in.fail("the GLB says it has " + std::to_string(length) + " bytes, the file holds " +
            std::to_string(out.gltf.size()));
  out.gltf = out.gltf.first(length);
  in.rest = out.gltf.subspan(12);
  for (int chunk = 0; in.rest.size() >= 8; ++chunk) {
    const std::uint32_t bytes = in.word("a chunk header"), type = in.word("a chunk header");
    const Bytes data = in.take(bytes, "a GLB chunk");
    if (chunk == 0 && type != json_chunk) in.fail("expected the GLB's first chunk to be JSON");
    if (chunk == 0) out.json = data;
    if (chunk == 1 && type == bin_chunk) out.bin = data;
  }
  if (out.json.empty()) in.fail("the GLB has no JSON chunk");
}

void open_tile_header(ByteCursor& in, const char* kind, std::uint32_t header_bytes) {
  const std::string header = std::string("the ") + kind + " header";
  in.word(header.c_str());
  if (const std::uint32_t version = in.word(header.c_str()); version != 1)
    in.fail(std::string("expected ") + kind + " version 1, got " + std::to_string(version));
  const std::uint32_t length = in.word(header.c_str());
  const std::uint64_t there = in.rest.size() + 12;
  if (length < header_bytes || length > there)
    in.fail(std::string("the ") + kind + " says it has " + std::to_string(length) + " bytes, the file holds " +
            std::to_string(there));
  in.rest = in.rest.first(length - 12);
}

TableLengths take_lengths(ByteCursor& in) {
  TableLengths lengths{};
  for (std::uint32_t& bytes : lengths) bytes = in.word("the tile's header");
  return lengths;
}

FeatureTable take_tables(ByteCursor& in, const TableLengths& lengths) {
  const Bytes json = in.take(lengths[0], "the feature table"), binary = in.take(lengths[1], "the feature table");
  in.take(lengths[2], "the batch table");
  in.take(lengths[3], "the batch table");
  return FeatureTable(in.file, json, binary);
}

FeatureTable take_b3dm_tables(ByteCursor& in) {
  const ByteCursor start = in;
  const B3dmLayout layout = b3dm_layout(take_lengths(in));
  in.rest = start.rest.subspan(layout.header_bytes - 12);
  return take_tables(in, layout.table_bytes);
}

/// Source  3D Tiles 1.0, "Batched 3D Model".
void open_b3dm(const std::filesystem::path& file, ContentContainer& out) {
  ByteCursor in{file, out.file, out.content};
  open_tile_header(in, "b3dm", 28);
  const FeatureTable table = take_b3dm_tables(in);
  out.gltf = in.rest;
  out.rtc_center = table.vector("RTC_CENTER").value_or(std::array<double, 3>{});
}

/// The URI may be padded with spaces or zeros.
std::string model_uri_of(Bytes bytes) {
  const std::string uri(bytes.begin(), bytes.end());
  return uri.substr(0, uri.find_last_not_of(std::string_view(" \0\t\r\n", 5)) + 1);
}

/// Source  3D Tiles 1.0, "Instanced 3D Model".
void open_i3dm(const TileRef& tile, const SourceFiles& files, ContentContainer& out) {
  ByteCursor in{tile.path, out.file, out.content};
  open_tile_header(in, "i3dm", 32);
  const TableLengths lengths = take_lengths(in);
  const std::uint32_t format = in.word("the i3dm header");
  if (format > 1) in.fail("expected the i3dm's gltfFormat to be 0 or 1, got " + std::to_string(format));
  const FeatureTable table = take_tables(in, lengths);
  out.rtc_center = table.vector("RTC_CENTER").value_or(std::array<double, 3>{});
  out.instances = i3dm_instances(tile.path, table, tile.world_from_tile, out.rtc_center);
  out.is_instanced = true;
  out.gltf = in.rest;
  if (format == 1) return;
  out.model_uri = model_uri_of(in.rest);
  out.gltf_file = resolve_uri(files.root(), tile.path, "glTF URI", out.model_uri);
  out.model = files.read_content(out.gltf_file);
  out.gltf = out.model;
}

Bytes content_of(const TileRef& tile, Bytes file) {
  if (tile.range == ByteRange()) return file;
  if (tile.range.end > file.size() || tile.range.begin > tile.range.end)
    throw InputError(tile.path, "", "is shorter than it was; it changed meanwhile");
  return file.subspan(tile.range.begin, tile.range.end - tile.range.begin);
}

}  // namespace

SourceFiles files_of(const TileRef& tile, const std::filesystem::path& root) {
  return tile.archive ? SourceFiles(tile.archive) : SourceFiles(root);
}

ContentContainer open_container(const TileRef& tile, const SourceFiles& files) {
  ContentContainer out;
  out.file = files.read_content(tile.path);
  out.content = content_of(tile, out.file);
  out.gltf = out.content;
  out.gltf_file = tile.path;
  const ContentMagic magic = content_magic(out.content);
  if (magic == ContentMagic::b3dm) open_b3dm(tile.path, out);
  if (magic == ContentMagic::i3dm) open_i3dm(tile, files, out);
  out.is_binary = content_magic(out.gltf) == ContentMagic::glb;
  if (out.is_binary)
    open_glb(out.gltf_file, out);
  else
    out.json = out.gltf;
  if (out.json.empty()) throw InputError(out.gltf_file, "", "holds no glTF");
  return out;
}

}  // namespace gigabake
