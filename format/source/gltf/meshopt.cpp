#include <meshoptimizer.h>

#include "core/base/error.h"
#include "format/source/image/codecs.h"

namespace gigabake {
namespace {

int decode(const MeshoptStream& s, std::span<const std::uint8_t> packed, std::uint8_t* out) {
  switch (s.mode) {
    case MeshoptMode::triangles:
      return meshopt_decodeIndexBuffer(out, s.count, s.stride, packed.data(), packed.size());
    case MeshoptMode::indices:
      return meshopt_decodeIndexSequence(out, s.count, s.stride, packed.data(), packed.size());
    case MeshoptMode::attributes:
      break;
  }
  return meshopt_decodeVertexBuffer(out, s.count, s.stride, packed.data(), packed.size());
}

}  // namespace

bool has_meshopt() { return true; }

std::vector<std::uint8_t> decode_meshopt(const std::filesystem::path& file, const std::string& where,
                                         const MeshoptStream& s, std::span<const std::uint8_t> packed) {
  std::vector<std::uint8_t> out(s.count * s.stride);
  if (decode(s, packed, out.data()) != 0) throw InputError(file, where, "not a whole stream of meshopt");
  if (s.filter == MeshoptFilter::octahedral) meshopt_decodeFilterOct(out.data(), s.count, s.stride);
  if (s.filter == MeshoptFilter::quaternion) meshopt_decodeFilterQuat(out.data(), s.count, s.stride);
  if (s.filter == MeshoptFilter::exponential) meshopt_decodeFilterExp(out.data(), s.count, s.stride);
  return out;
}

}  // namespace gigabake
