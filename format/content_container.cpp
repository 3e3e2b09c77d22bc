#include "format/content_container.h"

#include <cstring>

#include "format/error.h"

namespace gigabake {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::uint32_t json_chunk = 0x4e4f534a, bin_chunk = 0x004e4942;

/// Reads little-endian words with their place in the file for errors.
struct Cursor {
  const std::filesystem::path& file;
  Bytes whole, rest;

  std::uint64_t at() const { return std::uint64_t(rest.data() - whole.data()); }
  [[noreturn]] void fail(const std::string& message) const { throw InputError(file, "", message, at()); }
  std::uint32_t word(const char* what) {
    std::uint32_t v;
    std::memcpy(&v, take(4, what).data(), 4);
    return v;
  }
  Bytes take(std::uint64_t bytes, const char* what) {
    if (bytes > rest.size()) fail(std::string("the file ends inside ") + what);
    const Bytes taken = rest.first(bytes);
    rest = rest.subspan(bytes);
    return taken;
  }
};

/// Source  glTF 2.0, "GLB File Format Specification".
void open_glb(const std::filesystem::path& file, ContentContainer& out) {
  Cursor in{file, out.file, out.gltf};
  in.word("the GLB header");
  const std::uint32_t version = in.word("the GLB header");
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

/// Source  3D Tiles 1.0, "Batched 3D Model"; RTC_CENTER in the feature table, inline or in its binary part.
void open_b3dm(const std::filesystem::path& file, ContentContainer& out) {
  Cursor in{file, out.file, out.file};
  in.word("the b3dm header");
  const std::uint32_t version = in.word("the b3dm header");
  if (version != 1) in.fail("expected b3dm version 1, got " + std::to_string(version));
  const std::uint32_t length = in.word("the b3dm header");
  if (length < 28 || length > out.file.size())
    in.fail("the b3dm says it has " + std::to_string(length) + " bytes, the file holds " +
            std::to_string(out.file.size()));
  std::uint32_t table_bytes[4];
  for (std::uint32_t& bytes : table_bytes) bytes = in.word("the b3dm header");
  in.rest = in.rest.first(length - 28);
  const Bytes feature_json = in.take(table_bytes[0], "the feature table"),
              feature_bin = in.take(table_bytes[1], "the feature table");
  in.take(table_bytes[2], "the batch table");
  in.take(table_bytes[3], "the batch table");
  out.gltf = in.rest;
  if (feature_json.empty()) return;
  const Json table = parse_json(file, feature_json);
  if (!table.is_object() || !table.contains("RTC_CENTER")) return;
  const Json& center = table["RTC_CENTER"];
  if (center.is_object()) {
    const auto offset = get_index(file, center, "RTC_CENTER", "byteOffset");
    float v[3];
    if (!offset || *offset > feature_bin.size() || feature_bin.size() - *offset < sizeof v)
      throw InputError(file, "RTC_CENTER.byteOffset", "expected three floats inside the feature table");
    std::memcpy(v, feature_bin.data() + *offset, sizeof v);
    out.rtc_center = {v[0], v[1], v[2]};
    for (const double x : out.rtc_center)
      if (!std::isfinite(x)) throw InputError(file, "RTC_CENTER", "expected 3 finite numbers");
    return;
  }
  const auto v = get_numbers(file, table, "", "RTC_CENTER", 3);
  if (v) out.rtc_center = {(*v)[0], (*v)[1], (*v)[2]};
}

}  // namespace

ContentContainer open_container(const TileRef& tile) {
  ContentContainer out;
  out.file = read_whole_file(tile.path);
  out.gltf = out.file;
  const auto magic_is = [&](const char* magic) {
    return out.gltf.size() >= 4 && std::memcmp(out.gltf.data(), magic, 4) == 0;
  };
  if (magic_is("b3dm")) open_b3dm(tile.path, out);
  out.is_binary = magic_is("glTF");
  if (out.is_binary)
    open_glb(tile.path, out);
  else
    out.json = out.gltf;
  if (out.json.empty()) throw InputError(tile.path, "", "holds no glTF");
  return out;
}

}  // namespace gigabake
