#include "worker/worker_setup.h"

#include "format/bytes.h"
#include "format/option_bytes.h"

namespace gigabake {
namespace {

constexpr std::int32_t no_device = -1;

void put(ByteWriter& writer, const WorkerOptions& options) {
  writer.put(std::int32_t(options.threads));
  writer.put(options.memory_bytes);
  writer.put(options.out.string());
  writer.put(std::int32_t(options.cuda_device.value_or(no_device)));
}

WorkerOptions get_worker_options(ByteReader& reader) {
  WorkerOptions options;
  std::int32_t threads = 0, device = no_device;
  std::string out;
  reader.get(threads), reader.get(options.memory_bytes), reader.get(out), reader.get(device);
  if (threads < 1) throw InputError("worker options", "threads", "expected 1 or more");
  if (device < no_device) throw InputError("worker options", "cuda_device", "expected an ordinal");
  options.threads = threads;
  options.out = out;
  if (device != no_device) options.cuda_device = device;
  return options;
}

}  // namespace

std::vector<std::uint8_t> to_bytes(const WorkerSetup& setup) {
  ByteWriter w;
  w.put(setup.source.string());
  put(w, setup.source_options);
  put(w, setup.parameters);
  put(w, setup.worker);
  w.put(setup.tiles);
  return w.take();
}

WorkerSetup setup_from_bytes(std::span<const std::uint8_t> bytes) {
  ByteReader r(bytes, "worker setup");
  WorkerSetup setup;
  std::string source;
  r.get(source);
  setup.source = source;
  setup.source_options = get_source_options(r);
  setup.parameters = get_parameters(r);
  setup.worker = get_worker_options(r);
  r.get(setup.tiles);
  r.expect_end();
  return setup;
}

}  // namespace gigabake
