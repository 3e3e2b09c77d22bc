#include "cluster/launch/build_identity.h"

#include <algorithm>
#include <cstring>
#include <elf.h>
#include <fmt/format.h>
#include <link.h>
#include <span>
#include <stdexcept>
#include <vector>

#include "cluster/mpi/collective.h"
#include "cluster/mpi/mpi_call_timeout.h"
#include "core/base/kernel_version.h"

namespace gigabake {
namespace {

constexpr std::size_t note_alignment = 4;

std::size_t aligned(std::size_t bytes) { return (bytes + note_alignment - 1) / note_alignment * note_alignment; }

/// Returns the build id among the notes of one segment; empty if there is none.
std::span<const std::uint8_t> id_in_notes(std::span<const std::uint8_t> notes) {
  while (notes.size() >= sizeof(ElfW(Nhdr))) {
    ElfW(Nhdr) note;
    std::memcpy(&note, notes.data(), sizeof note);
    const std::size_t name = sizeof note, content = name + aligned(note.n_namesz);
    const std::size_t end = content + aligned(note.n_descsz);
    if (end > notes.size()) return {};
    if (note.n_type == NT_GNU_BUILD_ID && note.n_namesz == 4 && std::memcmp(&notes[name], "GNU", 4) == 0)
      return notes.subspan(content, note.n_descsz);
    notes = notes.subspan(end);
  }
  return {};
}

/// Reads the build id of the first object that the loader lists, which is the program itself.
int take_id(dl_phdr_info* object, std::size_t, void* identity) {
  auto& build = *static_cast<BuildIdentity*>(identity);
  for (const ElfW(Phdr) & segment : std::span(object->dlpi_phdr, object->dlpi_phnum)) {
    if (segment.p_type != PT_NOTE) continue;
    const auto* start = reinterpret_cast<const std::uint8_t*>(object->dlpi_addr + segment.p_vaddr);
    const auto id = id_in_notes({start, segment.p_memsz});
    if (id.empty() || id.size() > build.id.size()) continue;
    std::ranges::copy(id, build.id.begin());
    build.id_bytes = std::uint32_t(id.size());
  }
  return 1;  // no further objects
}

template <std::size_t size>
void put_text(const std::string& text, std::array<char, size>& out) {
  std::copy_n(text.begin(), std::min(text.size(), size), out.begin());
}

template <std::size_t size>
std::string get_text(const std::array<char, size>& text) {
  return {text.begin(), std::find(text.begin(), text.end(), '\0')};
}

}  // namespace

BuildIdentity this_build(const std::string& command) {
  BuildIdentity build;
  build.kernel_version = kernel_version;
  put_text(GIGABAKE_VERSION, build.version);
  put_text(command, build.command);
  ::dl_iterate_phdr(take_id, &build);
  return build;
}

std::string describe(const BuildIdentity& build) {
  constexpr std::size_t shown_bytes = 8;
  std::string id;
  for (std::size_t i = 0; i < std::min<std::size_t>(build.id_bytes, shown_bytes); ++i)
    id += fmt::format("{:02x}", build.id.at(i));
  return fmt::format("{} of gigabake {}, kernel version {}, build {}", get_text(build.command), get_text(build.version),
                     build.kernel_version, id.empty() ? "unknown" : id);
}

void expect_same_build(MpiSession& mpi, const std::string& command) {
  const BuildIdentity own = this_build(command);
  std::vector<std::uint8_t> bytes(sizeof own);
  std::memcpy(bytes.data(), &own, sizeof own);
  const double previous_timeout_s = mpi.collective_timeout_s();
  mpi.set_collective_timeout(max_mpi_call_s());  // an older program on rank 0 sends another message, or none
  bytes = mpi.from_master(std::move(bytes));
  collective_try(mpi, [&] {
    BuildIdentity first;
    if (bytes.size() == sizeof first) std::memcpy(&first, bytes.data(), sizeof first);
    if (bytes.size() != sizeof first || first.magic != own.magic)
      throw std::runtime_error("rank 0 runs another program than this rank's " + describe(own));
    if (first != own)
      throw std::runtime_error("this rank runs " + describe(own) + "; rank 0 runs " + describe(first) +
                               ": all ranks of a launch need the same program");
  });
  mpi.set_collective_timeout(previous_timeout_s);
}

}  // namespace gigabake
