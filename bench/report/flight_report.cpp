#include "bench/report/flight_report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace gigabake::bench {
namespace {

nlohmann::ordered_json row_json(const FlightRow& row) {
  const FlightTimes& t = row.times;
  return {{"step_m", row.step_m},
          {"frames_per_s", row.frames_per_s},
          {"frames", t.frames},
          {"mean_psnr_db", t.mean_psnr_db},
          {"worst_psnr_db", t.worst_psnr_db},
          {"compared_frames", t.compared_frames},
          {"median_s", t.median_s},
          {"p99_s", t.p99_s},
          {"worst_s", t.worst_s},
          {"late", t.late},
          {"uploads", t.uploads},
          {"uploaded_bytes", t.uploaded_bytes},
          {"peak_bytes", t.peak_bytes},
          {"surface_pixels", t.surface_pixels}};
}

nlohmann::ordered_json still_json(const StillRow& row) {
  return {{"at", row.at},
          {"mode", row.mode},
          {"compared_pixels", row.compared_pixels},
          {"voxels", {{"psnr_db", row.voxels.psnr_db}, {"flip", row.voxels.flip}, {"bytes", row.voxel_bytes}}},
          {"mesh",
           {{"psnr_db", row.mesh.psnr_db},
            {"flip", row.mesh.flip},
            {"triangles", row.mesh_triangles},
            {"bytes", row.mesh_bytes}}}};
}

std::string row_text(const FlightRow& row) {
  const FlightTimes& t = row.times;
  return fmt::format(
      "| {:g} | {:g} | {} | {:.1f}; {:.1f} | {:.1f}; {:.1f}; {:.1f} | {:.1f} | {:.0f}; {:.2f} | {:.1f} |\n", row.step_m,
      row.frames_per_s, t.frames, t.mean_psnr_db, t.worst_psnr_db, 1e3 * t.median_s, 1e3 * t.p99_s, 1e3 * t.worst_s,
      100 * t.late, double(t.uploads) / t.frames, double(t.uploaded_bytes) / t.frames / 1e6,
      double(t.peak_bytes) / 1e6);
}

std::string still_text(const StillRow& row) {
  return fmt::format("| {:.2f} {} | {} | {:.4f}; {:.1f} | {:.4f}; {:.1f} | {:.1f} | {} | {:.1f} |\n", row.at, row.mode,
                     row.compared_pixels, row.voxels.flip, row.voxels.psnr_db, row.mesh.flip, row.mesh.psnr_db,
                     double(row.voxel_bytes) / 1e6, row.mesh_triangles, double(row.mesh_bytes) / 1e6);
}

}  // namespace

std::string to_json(const FlightBench& bench) {
  nlohmann::ordered_json j{
      {"bench", "flight"},        {"scene", bench.scene},     {"voxel_size_m", bench.voxel_size_m},
      {"backend", bench.backend}, {"samples", bench.samples}, {"size", {bench.width, bench.height}},
      {"threads", bench.threads}, {"orbit_m", bench.orbit_m}, {"source_triangles", bench.source_triangles}};
  for (const FlightRow& row : bench.flights) j["flights"].push_back(row_json(row));
  for (const StillRow& row : bench.stills) j["stills"].push_back(still_json(row));
  return j.dump(2) + "\n";
}

std::string to_markdown(const FlightBench& bench) {
  std::string out = fmt::format(
      "Flights along one orbit of {:.4g} m, {}×{}, {}. Each begins at rest. Frames as displayed are compared with "
      "complete images; equal images count as 100 dB. Late frames take longer than the period of the display.\n\n"
      "| m per frame | Hz | frames | PSNR, dB: mean; worst | frame, ms: median; 99 %; worst | late, % | uploads per "
      "frame; MB | pools and pages, MB |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- |\n",
      bench.orbit_m, bench.width, bench.height, bench.backend);
  for (const FlightRow& row : bench.flights) out += row_text(row);
  out += fmt::format(
      "\nStill images against all {} triangles of the source, {} rays a pixel. The mesh has levels of at most {:g} "
      "pixel of error; its bytes are indices and vertices, without textures.\n\n"
      "| still image | compared pixels | voxels: FLIP; PSNR, dB | mesh: FLIP; PSNR, dB | voxels: pools and pages, MB | "
      "mesh: triangles | mesh, MB |\n"
      "| --- | --- | --- | --- | --- | --- | --- |\n",
      bench.source_triangles, bench.samples, mesh_pixel_error);
  for (const StillRow& row : bench.stills) out += still_text(row);
  return out;
}

}  // namespace gigabake::bench
