#include <draco/compression/decode.h>
#include <draco/core/decoder_buffer.h>
#include <draco/mesh/mesh.h>

#include "core/base/memory_limit.h"
#include "core/base/pluralize.h"
#include "core/io/byte_cursor.h"
#include "format/source/image/codecs.h"

namespace gigabake {
namespace {

std::uint64_t varint(ByteCursor& in) {
  std::uint64_t v = 0;
  for (int shift = 0; shift < 35; shift += 7) {
    const std::uint8_t byte = in.take(1, "the Draco stream's header")[0];
    v |= std::uint64_t(byte & 0x7f) << shift;
    if (byte < 0x80) return v;
  }
  in.fail("the Draco stream's header has a number of more than 32 bits");
}

/// Returns the number of triangles in the stream's header. Returns nullopt if metadata precede the number, or if the
/// version of the stream is below 2.2.
/// Source  Draco bitstream specification 2.2, 4 and 6.
std::optional<std::uint64_t> announced_triangles(const std::filesystem::path& file,
                                                 std::span<const std::uint8_t> packed) {
  ByteCursor in{file, packed, packed};
  const auto byte = [&] { return in.take(1, "the Draco stream's header")[0]; };
  in.take(5, "the Draco stream's header");  // "DRACO", which the library checks
  const int major = byte(), minor = byte();
  const int geometry = byte(), method = byte();
  const int flags = byte() | byte() << 8;
  if (geometry != 1) in.fail("the Draco stream holds no triangles");
  if (major * 256 + minor < 2 * 256 + 2 || (flags & 0x8000) != 0) return std::nullopt;
  if (method == 1) {  // for edge breaker, the traversal method and the number of vertices precede the triangles
    byte();
    varint(in);
  }
  return varint(in);
}

std::vector<float> values_of(const draco::Mesh& mesh, const draco::PointAttribute& attribute,
                             const DracoAttribute& as) {
  const std::size_t points = mesh.num_points();
  std::vector<float> out(points * as.components, 0.0f);
  const bool is_share =
      as.integers_to_one != 0 && !attribute.normalized() && attribute.data_type() != draco::DT_FLOAT32;
  for (std::size_t p = 0; p < points; ++p) {
    float* to = &out[p * as.components];
    const auto index = attribute.mapped_index(draco::PointIndex(std::uint32_t(p)));
    if (index.value() >= attribute.size()) continue;  // the stream is damaged
    attribute.ConvertValue<float>(index, std::int8_t(as.components), to);
    for (std::size_t c = 0; is_share && c < as.components; ++c) to[c] = std::max(to[c] / as.integers_to_one, -1.0f);
  }
  return out;
}

}  // namespace

bool has_draco() { return true; }

DracoMesh decode_draco(const std::filesystem::path& file, const std::string& where,
                       std::span<const std::uint8_t> packed, std::span<const DracoAttribute> attributes,
                       std::uint64_t max_triangles) {
  const auto announced = announced_triangles(file, packed);
  if (announced && *announced > max_triangles)
    throw InputError(file, where,
                     "the Draco stream states " + pluralize(*announced, "triangle") + ", the document " +
                         std::to_string(max_triangles));
  constexpr std::uint64_t triangle_bytes = 100;  // three corners, in the library's mesh and in the output
  MemoryClaim(file).add_items(announced.value_or(0), triangle_bytes, where, "triangles packed by Draco");
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(packed.data()), packed.size());
  draco::Decoder decoder;
  const auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok())
    throw InputError(file, where, std::string("not a whole Draco mesh: ") + decoded.status().error_msg());
  const draco::Mesh& mesh = *decoded.value();
  DracoMesh out;
  out.points = mesh.num_points();
  for (std::uint32_t f = 0; f < mesh.num_faces(); ++f)
    for (const draco::PointIndex& corner : mesh.face(draco::FaceIndex(f))) out.index.push_back(corner.value());
  for (const DracoAttribute& wanted : attributes) {
    const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(wanted.unique_id);
    if (attribute == nullptr)
      throw InputError(file, where, "the Draco mesh has no attribute " + std::to_string(wanted.unique_id));
    out.attributes.push_back(values_of(mesh, *attribute, wanted));
  }
  return out;
}

}  // namespace gigabake
