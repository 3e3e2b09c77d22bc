/// A disk that is full, for as long as a test needs one.
#pragma once

#include <csignal>
#include <cstdint>
#include <sys/resource.h>

namespace gigabake::test {

/// Files of this process end at `bytes`: whoever writes beyond is told so by the system.
class FilesEndAt {
 public:
  explicit FilesEndAt(std::uint64_t bytes) {
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FilesEndAt() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int);
};

}  // namespace gigabake::test
