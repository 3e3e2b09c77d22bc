#include "tests/fuzz/judge.h"

#include <exception>

#include "core/base/error.h"
#include "core/base/quote.h"

namespace gigabake::fuzz {
namespace {

std::string fault_of_line(const std::string& line) {
  if (line.empty() || line.find('\n') != std::string::npos || line.size() > max_line_bytes)
    return "expected one clear line, got: " + line;
  if (line.ends_with("…")) return "expected the end of the reason, got: " + line;
  return "";
}

}  // namespace

std::string fault_of(Reader reader, Bytes bytes) {
  try {
    reader(bytes);
  } catch (const InputError& e) {
    return fault_of_line(e.what());
  } catch (const UsageError& e) {
    return fault_of_line(e.what());
  } catch (const FaultFound& e) {
    return e.what();
  } catch (const std::exception& e) {
    return std::string("expected an InputError, got: ") + e.what();
  }
  return "";
}

std::vector<Bytes> parts_of(Bytes bytes) {
  std::vector<Bytes> parts;
  std::string_view rest(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  for (;;) {
    const std::size_t end = rest.find(part_mark);
    const std::string_view part = rest.substr(0, end);
    parts.emplace_back(reinterpret_cast<const std::uint8_t*>(part.data()), part.size());
    if (end == std::string_view::npos) return parts;
    rest.remove_prefix(end + part_mark.size());
  }
}

}  // namespace gigabake::fuzz
