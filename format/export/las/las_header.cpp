#include "format/export/las/las_header.h"

#include <string_view>

#include "core/base/error.h"

namespace gigabake {
namespace {

constexpr std::uint16_t las_header_bytes = 375, record_head_bytes = 54, extra_bytes_bytes = 192;
constexpr std::uint16_t wkt_record = 2112, extra_bytes_record = 4;
constexpr std::uint16_t has_wkt = 1 << 4;  // in the global encoding
constexpr std::uint8_t type_uchar = 1, type_ushort = 3, type_float = 9;

/// Writes bytes in little endian.
class LasBytes {
 public:
  template <class T>
  void put(const T& value) {
    const auto* const from = reinterpret_cast<const std::uint8_t*>(&value);
    bytes.insert(bytes.end(), from, from + sizeof(T));
  }
  void zeros(std::size_t count) { bytes.insert(bytes.end(), count, 0); }
  /// Writes a field of characters, filled with zeros.
  void text(std::string_view value, std::size_t size) {
    value = value.substr(0, size);
    bytes.insert(bytes.end(), value.begin(), value.end());
    zeros(size - value.size());
  }
  void record_head(std::string_view user, std::uint16_t id, std::size_t length, std::string_view description) {
    put(std::uint16_t(0));
    text(user, 16);
    put(id);
    put(std::uint16_t(length));
    text(description, 32);
  }
  /// Writes the description of one value in the extra bytes of a point.
  void extra_value(std::uint8_t type, std::string_view name, std::string_view description) {
    zeros(2);
    put(type);
    put(std::uint8_t(0));  // options: no minimum, maximum, scale or offset
    text(name, 32);
    zeros(4 + 5 * 24);
    text(description, 32);
  }

  std::vector<std::uint8_t> bytes;
};

}  // namespace

std::vector<std::uint8_t> las_header(const LasHeader& header, std::uint64_t points, const LasBounds& bounds) {
  const std::size_t wkt_bytes = header.wkt.size() + 1,
                    extra_values = std::size_t(1 + (header.has_normals ? 3 : 0) + (header.has_classes ? 1 : 0));
  if (wkt_bytes > 65535) throw InputError("", "crs", "its WKT has more than 65,534 bytes, the limit of LAS");
  LasBytes out;
  out.text("LASF", 4);
  out.put(std::uint16_t(0));  // file source
  out.put(has_wkt);
  out.zeros(16);  // project
  out.put(std::uint8_t(1)), out.put(std::uint8_t(4));
  out.text("OTHER", 32);
  out.text(header.software, 32);
  out.zeros(4);  // date: not stated, so that equal scenes give equal bytes
  out.put(las_header_bytes);
  out.put(std::uint32_t(las_header_bytes + 2 * record_head_bytes + wkt_bytes + extra_values * extra_bytes_bytes));
  out.put(std::uint32_t(2));  // records
  out.put(std::uint8_t(7));   // point format
  out.put(las_point_bytes(header));
  out.zeros(24);  // counts of formats before LAS 1.4
  for (const double v : header.scale) out.put(v);
  for (const double v : header.offset) out.put(v);
  for (std::size_t c = 0; c < 3; ++c)
    for (const std::int32_t v : {bounds.high[c], bounds.low[c]})
      out.put(points == 0 ? 0.0 : double(v) * header.scale[c] + header.offset[c]);
  out.zeros(8 + 8 + 4);  // no waveforms, no extended records
  out.put(points);
  out.put(points);  // first returns
  out.zeros(14 * 8);
  out.record_head("LASF_Projection", wkt_record, wkt_bytes, "coordinate system");
  out.text(header.wkt, wkt_bytes);
  out.record_head("LASF_Spec", extra_bytes_record, extra_values * extra_bytes_bytes, "extra bytes");
  out.extra_value(type_uchar, "coverage", "of the voxel, 255: full");
  if (header.has_normals)
    for (const char* name : {"NormalX", "NormalY", "NormalZ"})
      out.extra_value(type_float, name, "along the axes of the scene");
  if (header.has_classes) out.extra_value(type_ushort, "VoxelClass", "0: none");
  return out.bytes;
}

}  // namespace gigabake
