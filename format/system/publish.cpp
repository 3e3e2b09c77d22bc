#include "format/system/publish.h"

#include <fcntl.h>
#include <span>
#include <unistd.h>
#include <utility>

#include "format/system/descriptor.h"
#include "format/system/publish_place.h"

namespace gigabake {

Publication::Publication(std::filesystem::path target, Leftovers leftovers) : target_(std::move(target)) {
  const auto make = [](const std::filesystem::path& name) { return Descriptor(name, O_WRONLY | O_CREAT | O_EXCL); };
  if (leftovers == Leftovers::keep) {
    temporary_ = create_temporary(target_, [&](const std::filesystem::path& name) { return make(name).is_open(); });
    return;
  }
  remove_abandoned_temporaries(target_);
  LockedTemporary made = create_locked_temporary(target_, make);
  temporary_ = std::move(made.path);
  lock_ = std::move(made.lock);
}

Publication::~Publication() {
  if (!published_) ::unlink(temporary_.c_str());
}

void Publication::publish(Durability durability) {
  const bool flush = durability == Durability::across_power_loss;
  if (flush) flush_file(temporary_);
  rename_into_place(temporary_, target_);
  published_ = true;
  if (flush) flush_folder_of(target_);
}

void publish_file(const std::filesystem::path& target, std::string_view content, Durability durability,
                  Leftovers leftovers) {
  Publication file(target, leftovers);
  {
    const Descriptor out(file.temporary(), O_WRONLY | O_TRUNC);
    const std::span bytes(reinterpret_cast<const std::uint8_t*>(content.data()), content.size());
    if (!out.is_open() || !out.write_all(bytes)) fail_to(target, "write");
  }
  file.publish(durability);
}

void flush_file_system_of(const std::filesystem::path& folder) {
  const Descriptor opened(folder, O_RDONLY | O_DIRECTORY);
  if (!opened.is_open() || ::syncfs(opened.get()) != 0) fail_to(folder, "flush");
}

}  // namespace gigabake
