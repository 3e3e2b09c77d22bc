#include "format/system/meters/trace_file.h"

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <string>
#include <sys/syscall.h>
#include <unistd.h>

#include "core/base/trace.h"

namespace gigabake {
namespace {

double microseconds(TraceClock::duration time) { return std::chrono::duration<double, std::micro>(time).count(); }

/// The file of this process. It is a JSON array without its end, as the format permits, because the processes of a bake
/// may be killed at any time.
class TraceFile {
 public:
  explicit TraceFile(const std::string& path) : file_(std::fopen(path.c_str(), "w")) {
    if (!file_) return;
    std::setvbuf(file_.get(), nullptr, _IOLBF, BUFSIZ);  // a process that is killed loses no complete line
    std::fputs("[\n", file_.get());
  }
  bool is_open() const { return file_ != nullptr; }

  void add(const char* name, const std::string& what, TraceClock::time_point start, TraceClock::time_point end) {
    constexpr auto line = R"({"name":"%s","ph":"X","ts":%.1f,"dur":%.1f,"pid":%d,"tid":%ld,"args":{"of":"%s"}},)"
                          "\n";
    const std::scoped_lock lock(mutex_);
    std::fprintf(file_.get(), line, name, microseconds(start.time_since_epoch()), microseconds(end - start),
                 int(::getpid()), long(::syscall(SYS_gettid)), what.c_str());
  }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  std::mutex mutex_;
  std::unique_ptr<std::FILE, Close> file_;
};

std::unique_ptr<TraceFile> trace_file;

}  // namespace

void record_trace() {
  const char* prefix = std::getenv("GIGABAKE_TRACE");
  if (prefix == nullptr) return;
  trace_file = std::make_unique<TraceFile>(std::string(prefix) + "." + std::to_string(::getpid()) + ".json");
  if (!trace_file->is_open()) return;
  set_trace_sink([](const char* name, const std::string& what, TraceClock::time_point start,
                    TraceClock::time_point end) { trace_file->add(name, what, start, end); });
}

}  // namespace gigabake
