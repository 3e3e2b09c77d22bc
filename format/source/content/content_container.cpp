#include "format/source/content/content_container.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <string_view>

#include "core/base/memory_limit.h"
#include "core/io/byte_cursor.h"
#include "format/source/classes/source_classes.h"
#include "format/source/content/content_magic.h"
#include "format/source/gltf/version.h"
#include "format/source/tiles/b3dm_layout.h"
#include "format/source/tiles/feature_table.h"
#include "format/source/tiles/i3dm_instances.h"

namespace gigabake {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::uint32_t json_chunk = 0x4e4f534a, bin_chunk = 0x004e4942;

/// A cursor like ByteCursor, over a GLB that may be in memory or in its file.
struct GlbCursor {
  const std::filesystem::path& file;
  SourceBytes rest;

  [[noreturn]] void fail(const std::string& message) const { throw InputError(file, "", message, rest.begin()); }

  SourceBytes take(std::uint64_t bytes, const char* what) {
    if (bytes > rest.size()) fail(std::string("the file ends inside ") + what);
    const SourceBytes taken = rest.part(0, bytes);
    rest = rest.part(bytes, rest.size() - bytes);
    return taken;
  }
  std::uint32_t word(const char* what) {
    std::uint32_t v;
    std::vector<std::uint8_t> buffer;
    std::memcpy(&v, take(sizeof v, what).look(0, sizeof v, buffer).data(), sizeof v);
    return v;
  }
};

/// Reads the header and the chunks of a GLB.
/// Source  glTF 2.0, "GLB File Format Specification".
void open_glb(const std::filesystem::path& file, ContentContainer& out) {
  GlbCursor in{file, out.gltf};
  in.word("the GLB header");
  const std::uint32_t version = in.word("the GLB header");
  if (version == 1) refuse_gltf_1(file);
  if (version != 2) in.fail("expected GLB version 2, got " + std::to_string(version));
  const std::uint32_t length = in.word("the GLB header");
  if (length < 12 || length > out.gltf.size())
    in.fail("the GLB states a length of " + std::to_string(length) + " bytes, the file holds " +
            std::to_string(out.gltf.size()));
  out.gltf = out.gltf.part(0, length);
  in.rest = out.gltf.part(12, length - 12);
  for (int chunk = 0; in.rest.size() >= 8 || (chunk == 1 && !in.rest.empty()); ++chunk) {
    const std::uint32_t bytes = in.word("a chunk header"), type = in.word("a chunk header");
    if (chunk == 0 && type != json_chunk) in.fail("expected the GLB's first chunk to be JSON");
    if (chunk == 1 && type != bin_chunk) in.fail("expected the GLB's second chunk to be BIN");
    if (chunk == 1 && (bytes == 0 || bytes % 4 != 0))
      in.fail("expected the GLB's second chunk to have a multiple of 4 bytes, got " + std::to_string(bytes));
    const SourceBytes data = in.take(bytes, "a GLB chunk");
    if (chunk == 0) out.json = data;
    if (chunk == 1) out.bin = data;
  }
  if (out.json.empty()) in.fail("the GLB has no JSON chunk");
  MemoryClaim(file).add_items(out.json.size(), 1, "", "bytes of JSON");
  out.json = out.json.in_memory();
}

void open_tile_header(ByteCursor& in, const char* kind, std::uint32_t header_bytes) {
  const std::string header = std::string("the ") + kind + " header";
  in.word(header.c_str());
  if (const std::uint32_t version = in.word(header.c_str()); version != 1)
    in.fail(std::string("expected ") + kind + " version 1, got " + std::to_string(version));
  const std::uint32_t length = in.word(header.c_str());
  const std::uint64_t there = in.rest.size() + 12;
  if (length < header_bytes || length > there)
    in.fail(std::string("the ") + kind + " states a length of " + std::to_string(length) + " bytes, the file holds " +
            std::to_string(there));
  in.rest = in.rest.first(length - 12);
}

/// Returns the bytes of `content` that `in` has not read yet. `in` must have begun at the first byte of `content`.
SourceBytes rest_of(const SourceBytes& content, const ByteCursor& in) {
  return content.part(std::uint64_t(in.at()) - content.begin(), in.rest.size());
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

/// Reads the header and the feature table of a b3dm.
/// Source  3D Tiles 1.0, "Batched 3D Model".
void open_b3dm(ByteCursor in, ContentContainer& out) {
  open_tile_header(in, "b3dm", 28);
  const FeatureTable table = take_b3dm_tables(in);
  out.gltf = rest_of(out.content, in);
  out.rtc_center = table.vector("RTC_CENTER").value_or(std::array<double, 3>{});
}

/// Returns the URI of a model without its padding of spaces or zeros.
std::string model_uri_of(Bytes bytes) {
  const std::string uri(bytes.begin(), bytes.end());
  return uri.substr(0, uri.find_last_not_of(std::string_view(" \0\t\r\n", 5)) + 1);
}

/// Reads the ids of the instances if the source uses them. Without BATCH_ID, the numbers of the instances are the ids.
void take_instance_ids(const TileRef& tile, const FeatureTable& table, ContentContainer& out) {
  out.has_unused_instance_ids = table.has("BATCH_ID") && !takes_instance_ids(tile.classes.get());
  if (!takes_instance_ids(tile.classes.get())) return;
  out.instance_ids = table.ids("BATCH_ID", out.instances.size());
  if (!out.instance_ids.empty()) return;
  out.instance_ids.resize(out.instances.size());
  std::iota(out.instance_ids.begin(), out.instance_ids.end(), 0);
}

/// Reads the header and the instances of an i3dm, and opens its glTF.
/// Source  3D Tiles 1.0, "Instanced 3D Model".
void open_i3dm(const TileRef& tile, const SourceFiles& files, ByteCursor in, ContentContainer& out) {
  open_tile_header(in, "i3dm", 32);
  const TableLengths lengths = take_lengths(in);
  const std::uint32_t format = in.word("the i3dm header");
  if (format > 1) in.fail("expected the i3dm's gltfFormat to be 0 or 1, got " + std::to_string(format));
  const FeatureTable table = take_tables(in, lengths);
  out.rtc_center = table.vector("RTC_CENTER").value_or(std::array<double, 3>{});
  out.instances = i3dm_instances(tile.path, table, tile.world_from_tile, out.rtc_center);
  out.is_instanced = true;
  take_instance_ids(tile, table, out);
  out.gltf = rest_of(out.content, in);
  if (format == 1) return;
  out.model_uri = model_uri_of(in.rest);
  out.gltf_file = resolve_uri(files.root(), tile.path, "glTF URI", out.model_uri);
  out.gltf = files.open_content(out.gltf_file);
}

SourceBytes content_of(const TileRef& tile, const SourceBytes& file) {
  if (tile.range == ByteRange()) return file;
  if (tile.range.end > file.size() || tile.range.begin > tile.range.end)
    throw InputError(tile.path, "", "became shorter while it was read");
  return file.part(tile.range.begin, tile.range.end - tile.range.begin);
}

ContentMagic magic_of(const SourceBytes& bytes) {
  std::vector<std::uint8_t> buffer;
  return content_magic(bytes.look(0, std::min<std::uint64_t>(bytes.size(), 4), buffer));
}

}  // namespace

SourceFiles files_of(const TileRef& tile, const std::filesystem::path& root) {
  return tile.archive ? SourceFiles(tile.archive) : SourceFiles(root);
}

ContentContainer open_container(const TileRef& tile, const SourceFiles& files) {
  ContentContainer out;
  const SourceBytes file = files.open_content(tile.path);
  out.content = content_of(tile, file);
  out.gltf = out.content;
  out.gltf_file = tile.path;
  const ContentMagic magic = magic_of(out.content);
  if (magic == ContentMagic::b3dm || magic == ContentMagic::i3dm) {
    const ByteCursor in{tile.path, file.span(), out.content.span()};
    magic == ContentMagic::b3dm ? open_b3dm(in, out) : open_i3dm(tile, files, in, out);
  }
  out.is_binary = magic_of(out.gltf) == ContentMagic::glb;
  if (out.is_binary)
    open_glb(out.gltf_file, out);
  else
    out.json = out.gltf;
  if (out.json.empty()) throw InputError(out.gltf_file, "", "holds no glTF");
  return out;
}

}  // namespace gigabake
