/// The materials that an OBJ names: what its material files state about them, and where their images are.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "format/source/mesh/obj_material.h"
#include "format/source/source.h"

namespace gigabake {

/// A material of some faces of an OBJ: those of the same name that have texture coordinates, or colours, or neither.
struct ObjMaterialUse {
  std::string name;
  bool has_uv = false, has_colour = false;

  friend auto operator<=>(const ObjMaterialUse&, const ObjMaterialUse&) = default;
};

class ObjMaterialTable {
 public:
  /// Both outlive this.
  ObjMaterialTable(const std::filesystem::path& file, const SourceFiles& files) : file_(file), files_(files) {}

  /// Reads the files that a line `mtllib` names. Errors  InputError: a material file that is no text.
  void take(const ObjLine& line);

  /// Counts what is missing for materials that faces name: material files, descriptions, images.
  void warn(const std::set<std::string>& used, SourceWarnings& warnings) const;
  /// Returns material files and images, there or missing, sorted.
  std::vector<std::filesystem::path> dependencies() const;
  /// Does the material show an image?
  bool has_image(const std::string& name) const;

  /// Appends the material and its image. Returns its index in out.materials.
  int add(const ObjMaterialUse& use, TileMesh& out);
  /// Returns how the material's image is placed.
  ObjMap placed_map(const std::string& name) const;

 private:
  /// With the file that describes it.
  struct Described {
    ObjMaterial material;
    std::filesystem::path file;
  };
  const Described* find(const std::string& name) const;
  bool is_usable(const Described& material, const ObjMap& map) const;
  int add_image(const Described& material, TileMesh& out);

  const std::filesystem::path& file_;
  const SourceFiles& files_;
  std::map<std::string, Described> described_;
  std::set<std::filesystem::path> mtl_files_;
  std::set<std::string> missing_;  ///< material files
  SourceWarnings mtl_warnings_;
  std::map<std::string, int> image_;
};

}  // namespace gigabake
