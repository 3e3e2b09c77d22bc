// Readers of the records that a bake keeps about its progress, and of the messages between its processes.
#include <array>
#include <string>

#include "core/base/error.h"
#include "format/job/cell_job.h"
#include "scheduler/journal/journal_content.h"
#include "scheduler/journal/scan_cache.h"
#include "scheduler/status/bake_status.h"
#include "tests/format/source/source_scene.h"
#include "tests/fuzz/readers.h"
#include "worker/pipeline/bake_messages.h"
#include "worker/pipeline/worker_setup.h"

namespace gigabake::fuzz {
namespace {

void read_frames(Bytes bytes) {
  FrameReader frames;
  frames.add(bytes);
  while (frames.next()) {
  }
}

}  // namespace

void journal(Bytes bytes) {
  const JournalContent content({bytes.begin(), bytes.end()});
  content.find({});
  content.knows_cell("c_0_0_0");
  const JournalContent again(content.compacted([](const Hash128&) { return true; }));
  if (again.fingerprints() != content.fingerprints()) throw FaultFound("a journal written again has other records");
}

void scan_cache(Bytes bytes) {
  static const test::SourceFolder folder;
  const ScanCache cache(folder.write("survey.cache", std::string(bytes.begin(), bytes.end())));
  SceneSources sources;
  sources.tiles.emplace_back();
  cache.find(sources, 0, {});
}

void bake_status(Bytes bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const BakeStatus status = status_from_json("status.json", text);
  to_prometheus(status);
  const BakeStatus again = status_from_json("again.json", to_json(status));
  if (!(status_from_json("third.json", to_json(again)) == again))
    throw FaultFound("a status that was written is another one");
}

void bake_messages(Bytes bytes) {
  using Decoder = void (*)(Bytes);
  static constexpr std::array<Decoder, 9> decoders{
      read_frames,
      [](Bytes b) { device_from_bytes(b); },
      [](Bytes b) { order_from_bytes(b); },
      [](Bytes b) { answer_from_bytes(b); },
      [](Bytes b) { tile_of_request(b); },
      [](Bytes b) { setup_from_bytes(b); },
      [](Bytes b) { to_bytes(job_from_bytes(b)); },
      [](Bytes b) { to_bytes(report_from_bytes(b)); },
      [](Bytes b) { to_bytes(scan_from_bytes(b)); },
  };
  if (!bytes.empty()) decoders[bytes[0] % decoders.size()](bytes.subspan(1));
}

}  // namespace gigabake::fuzz
