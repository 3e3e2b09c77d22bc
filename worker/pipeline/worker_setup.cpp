#include "worker/pipeline/worker_setup.h"

#include "core/io/bytes.h"
#include "format/job/option_bytes.h"
#include "worker/pipeline/bake_messages.h"

namespace gigabake {
namespace {

void put(ByteWriter& writer, const WorkerOptions& options) {
  writer.put(std::int32_t(options.threads));
  writer.put(options.threads_are_a_share);
  writer.put(options.memory_is_default);
  writer.put(options.memory_bytes);
  writer.put(options.out.string());
  writer.put(options.scratch.string());
}

WorkerOptions get_worker_options(ByteReader& reader) {
  WorkerOptions options;
  std::int32_t threads = 0;
  std::string out, scratch;
  reader.get(threads), reader.get(options.threads_are_a_share), reader.get(options.memory_is_default),
      reader.get(options.memory_bytes), reader.get(out), reader.get(scratch);
  if (threads < 1) throw InputError("worker options", "threads", "expected 1 or more");
  options.threads = threads;
  options.out = out;
  options.scratch = scratch;
  return options;
}

}  // namespace

std::vector<std::uint8_t> to_bytes(const WorkerSetup& setup) {
  ByteWriter w;
  put(w, setup.parameters);
  put(w, setup.worker);
  w.put(to_bytes(setup.device));
  return w.take();
}

WorkerSetup setup_from_bytes(std::span<const std::uint8_t> bytes) {
  ByteReader r(bytes, "worker setup");
  WorkerSetup setup;
  setup.parameters = get_parameters(r);
  setup.worker = get_worker_options(r);
  std::vector<std::uint8_t> device;
  r.get(device);
  setup.device = device_request_from_bytes(device);
  r.expect_end();
  return setup;
}

}  // namespace gigabake
