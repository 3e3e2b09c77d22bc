/// The materials that an OBJ names: what its material files say of them, and where their images are.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "format/source/mesh/obj_material.h"
#include "format/source/source.h"

namespace gigabake {

class ObjMaterialTable {
 public:
  /// Both outlive this.
  ObjMaterialTable(const std::filesystem::path& file, const SourceFiles& files) : file_(file), files_(files) {}

  /// Reads the files that a line `mtllib` names. Errors  InputError as read_mtl() and material_files().
  void take(const ObjLine& line);

  /// The lines about files that are missing.
  std::vector<SourceWarning> warnings() const;
  /// Material files, there or missing, and images, sorted. Errors  InputError as map_file().
  std::vector<std::filesystem::path> dependencies() const;

  /// Appends the material and, of everything, its image. Returns its index in out.materials.
  /// Errors  InputError as map_file().
  int add(const std::string& name, bool has_colours, ReadScope scope, TileMesh& out);

 private:
  /// With what it was found in.
  struct Named {
    ObjMaterial material;
    std::filesystem::path file;
  };
  int add_image(const Named& material, TileMesh& out);

  const std::filesystem::path& file_;
  const SourceFiles& files_;
  std::map<std::string, Named> named_;
  std::set<std::filesystem::path> mtl_files_, missing_;
  std::map<std::string, int> image_;
};

}  // namespace gigabake
