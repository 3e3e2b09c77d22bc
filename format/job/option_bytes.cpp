#include "format/job/option_bytes.h"

namespace gigabake {
void put(ByteWriter& writer, const BakeParameters& parameters) { writer.put(to_json(parameters)); }

BakeParameters get_parameters(ByteReader& reader) {
  std::string json;
  reader.get(json);
  return parameters_from_json(json);
}

}  // namespace gigabake
