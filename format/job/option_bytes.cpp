#include "format/job/option_bytes.h"

namespace gigabake {
namespace {

/// Not the bool that a reader would trust: any other byte is malformed.
bool get_flag(ByteReader& reader, const char* key) {
  std::uint8_t value = 0;
  reader.get(value);
  if (value > 1) throw InputError("source options", key, "expected 0 or 1");
  return value == 1;
}

}  // namespace

void put(ByteWriter& writer, const SourceOptions& options) {
  writer.put(std::uint8_t(options.local));
  writer.put(std::uint8_t(options.origin.has_value()));
  if (options.origin) writer.put(*options.origin);
  writer.put(std::uint8_t(options.scene_up.has_value()));
  if (options.scene_up) writer.put(*options.scene_up);
}

SourceOptions get_source_options(ByteReader& reader) {
  SourceOptions options;
  options.local = get_flag(reader, "local");
  if (get_flag(reader, "origin")) reader.get(options.origin.emplace());
  if (get_flag(reader, "scene_up")) {
    std::uint8_t axis = 0;
    reader.get(axis);
    if (axis > std::uint8_t(UpAxis::x)) throw InputError("source options", "scene_up", "expected 0, 1 or 2");
    options.scene_up = UpAxis(axis);
  }
  return options;
}

void put(ByteWriter& writer, const BakeParameters& parameters) { writer.put(to_json(parameters)); }

BakeParameters get_parameters(ByteReader& reader) {
  std::string json;
  reader.get(json);
  return parameters_from_json(json);
}

}  // namespace gigabake
