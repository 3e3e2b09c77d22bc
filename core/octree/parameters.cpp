#include "core/octree/parameters.h"

#include <array>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/octree/octree.h"

namespace gigabake {

using OrderedJson = nlohmann::ordered_json;

namespace {

template <class Enum>
void get_named(const OrderedJson& j, const char* key, Enum& value) {
  const auto& name = j.at(key).get_ref<const std::string&>();
  const std::optional<Enum> known = value_named<Enum>(name);
  if (!known)
    throw InputError("parameters", key,
                     "is " + in_quotes(name) + ", which is unknown; a newer gigabake may have written it");
  value = *known;
}

void check_depth_error(const BakeParameters& p) {
  if (p.depth_error == 0) return;
  if (p.depth_error > 127)
    throw UsageError("depth_error", "expected 0 to 127 codes of 255, got " + std::to_string(p.depth_error));
  if (!p.normals || !has_directional_coverage(p))
    throw UsageError("depth_error", "compares planes, which need the filter coverage and all channels");
  if (p.cell_voxels < std::uint32_t(brick_edge) << max_ended_lod)
    throw UsageError("depth_error", fmt::format("needs cells of at least {} voxels, got {}",
                                                std::uint32_t(brick_edge) << max_ended_lod, p.cell_voxels));
}

}  // namespace

bool has_directional_coverage(const BakeParameters& p) {
  return p.directional_coverage && p.mip == MipFilter::coverage;
}

std::string to_json(const BakeParameters& p) {
  OrderedJson j;
  j["voxel_size_m"] = p.voxel_size_m;
  j["lattice_origin_m"] = p.lattice_origin_m;
  j["cell_voxels"] = p.cell_voxels;
  j["surface"] = name_of(p.surface);
  j["mip"] = name_of(p.mip);
  j["normals"] = p.normals;
  j["max_error"] = p.max_error;
  j["codec"] = name_of(p.codec);
  // Write the key "facing" only if its value is false. Parameter sets from before this option keep their JSON and
  // fingerprint.
  if (!p.directional_coverage) j["facing"] = false;
  if (p.depth_error != 0) j["depth_error"] = p.depth_error;
  if (p.coarsest_lod != 0) j["coarsest_lod"] = p.coarsest_lod;
  if (p.classes) j["classes"] = true;
  return j.dump();
}

BakeParameters parameters_from_json(const std::string& json) {
  BakeParameters p;
  try {
    const OrderedJson j = OrderedJson::parse(json);
    j.at("voxel_size_m").get_to(p.voxel_size_m);
    const auto origin_m = j.at("lattice_origin_m").get<std::array<double, 3>>();
    p.lattice_origin_m = {origin_m[0], origin_m[1], origin_m[2]};
    j.at("cell_voxels").get_to(p.cell_voxels);
    get_named(j, "surface", p.surface);
    get_named(j, "mip", p.mip);
    j.at("normals").get_to(p.normals);
    // Scenes of version 1 lack the parameters that were added later.
    p.codec = Codec::lz4;
    if (j.contains("max_error")) j.at("max_error").get_to(p.max_error);
    if (j.contains("codec")) get_named(j, "codec", p.codec);
    if (j.contains("facing")) j.at("facing").get_to(p.directional_coverage);
    if (j.contains("depth_error")) j.at("depth_error").get_to(p.depth_error);
    if (j.contains("coarsest_lod")) j.at("coarsest_lod").get_to(p.coarsest_lod);
    if (j.contains("classes")) j.at("classes").get_to(p.classes);
  } catch (const nlohmann::json::exception&) {
    throw InputError("parameters", "", "expected a JSON object with the parameters of a bake, as gigabake writes it");
  }
  check(p);
  return p;
}

void check(const BakeParameters& p) {
  if (!(p.voxel_size_m >= 1e-6 && p.voxel_size_m <= 1e6))
    throw UsageError("voxel_size_m", fmt::format("expected 1e-6 to 1e6 metres, got {:g}", p.voxel_size_m));
  if (!std::has_single_bit(p.cell_voxels) || p.cell_voxels < 8 || p.cell_voxels > 8192)
    throw UsageError("cell_voxels", "expected a power of two from 8 to 8192, got " + std::to_string(p.cell_voxels));
  if (p.max_error > 127)
    throw UsageError("max_error", "expected 0 to 127 codes of 255, got " + std::to_string(p.max_error));
  check_depth_error(p);
  const int levels = std::countr_zero(p.cell_voxels) - 2;
  if (int(p.coarsest_lod) >= levels)
    throw UsageError("coarsest_lod", fmt::format("expected 0 to {} for cells of {} voxels, got {}", levels - 1,
                                                 p.cell_voxels, p.coarsest_lod));
  if (p.coarsest_lod != 0 && p.mip == MipFilter::thesis)
    throw UsageError("mip", "thesis filters two levels at once, so that all sources need one voxel size; use coverage");
  if (p.classes && p.mip == MipFilter::thesis)
    throw UsageError("mip", "thesis filters two levels at once and no classes; use coverage or box");
  for (const double x : p.lattice_origin_m)
    if (!std::isfinite(x)) throw UsageError("lattice_origin_m", "expected three finite numbers in metres");
}

}  // namespace gigabake
