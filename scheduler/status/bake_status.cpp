#include "scheduler/status/bake_status.h"

#include <array>
#include <fstream>

#include "core/base/error.h"
#include "format/system/publish.h"

namespace gigabake {
namespace {

constexpr std::size_t max_status_bytes = std::size_t(64) << 20;

/// Returns the content up to the current end of the file.
/// Errors  InputError if the file does not exist, cannot be read, or exceeds max_status_bytes.
std::string text_of(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) throw InputError(file, "", "no such file");
  if (!std::filesystem::is_regular_file(file, error)) throw InputError(file, "", "expected a regular file");
  std::ifstream in(file, std::ios::binary);
  std::string text;
  std::array<char, 65536> part;
  while (in.read(part.data(), part.size()) || in.gcount() > 0) {
    text.append(part.data(), std::size_t(in.gcount()));
    if (text.size() > max_status_bytes) throw InputError(file, "", "is too large for the status of a bake");
  }
  if (!in.eof()) throw InputError(file, "", "cannot be read");
  return text;
}

}  // namespace

bool is_over(BakeState state) { return state >= BakeState::complete; }

std::filesystem::path status_file(const std::filesystem::path& out) { return out / "status.json"; }

void write_status(const std::filesystem::path& out, const BakeStatus& status) {
  publish_file(status_file(out), to_json(status) + "\n", Durability::while_up);
}

BakeStatus read_status(const std::filesystem::path& out) {
  const std::filesystem::path file = status_file(out);
  return status_from_json(file, text_of(file));
}

}  // namespace gigabake
