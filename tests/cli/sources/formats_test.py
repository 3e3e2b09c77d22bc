#!/usr/bin/env python3
"""Tests that each format README.md and docs/commands.md name is in a build with `tools/install-packages build`.

Usage: formats_test.py GIGABAKE SOURCE_DIR
"""
import json
import re
import struct
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "fuzz"))
import made_seeds
import packed_seeds

SOURCE = Path(sys.argv[2]).resolve()
MODEL = made_seeds.glb(made_seeds.square(), made_seeds.POSITIONS + made_seeds.INDICES)
CRS = b"EPSG:25832"
# GDAL's side file of a GeoTIFF without a coordinate system.
AUX = b"<PAMDataset><SRS>" + CRS + b"</SRS></PAMDataset>"
VRT = (b'<VRTDataset rasterXSize="4" rasterYSize="4"><SRS>' + CRS + b"</SRS>"
       b"<GeoTransform>500000, 10, 0, 5100160, 0, -10</GeoTransform>"
       b'<VRTRasterBand dataType="Byte" band="1"><SimpleSource><SourceFilename relativeToVRT="1">dem.tif'
       b"</SourceFilename><SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></VRTDataset>")
PRJ = b"""PROJCS["ETRS89 / UTM zone 32N",GEOGCS["ETRS89",DATUM["European_Terrestrial_Reference_System_1989",
SPHEROID["GRS 1980",6378137,298.257222101]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],
PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",9],
PARAMETER["scale_factor",0.9996],PARAMETER["false_easting",500000],PARAMETER["false_northing",0],UNIT["metre",1]]"""
B3DM = made_seeds.b3dm()
CMPT = b"cmpt" + struct.pack("<3I", 1, 16 + len(B3DM), 1) + B3DM
ASC = b"ncols 2\nnrows 2\nxllcorner 500000\nyllcorner 5100000\ncellsize 10\n1.5 2\n3 4\n"
HGT = b"\0\x40" * (1201 * 1201)
RASTER = {"gigabake": 1, "sources": [{"dem": "dem.tif", "crs": "EPSG:25832"}]}
# Source formats that README.md names: their files, and the path for `plan` ("" is the folder of the files).
SOURCES = {
    ".glb": ({"a.glb": MODEL}, "a.glb"),
    ".gltf": ({"a.gltf": made_seeds.text(made_seeds.square())}, "a.gltf"),
    ".b3dm": ({"a.b3dm": made_seeds.b3dm()}, "a.b3dm"),
    ".obj": ({"a.obj": b"v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n"}, "a.obj"),
    ".ply": ({"a.ply": made_seeds.plys()[0]}, "a.ply"),
    ".stl": ({"a.stl": made_seeds.stls()[0]}, "a.stl"),
    "a folder of them": ({"a.glb": MODEL, "b.gltf": made_seeds.text(made_seeds.square())}, ""),
    "tileset.json": ({"tileset.json": made_seeds.text(made_seeds.tileset(made_seeds.tile())),
                      "model.gltf": made_seeds.text(made_seeds.square())}, "tileset.json"),
    ".3tz": ({"a.3tz": made_seeds.archives()[0]}, "a.3tz"),
    ".i3dm": ({"a.i3dm": made_seeds.i3dm()[0]}, "a.i3dm"),
    ".cmpt": ({"a.cmpt": CMPT}, "a.cmpt"),
    ".tif": ({"dem.tif": made_seeds.tiff(4, 1), "dem.tif.aux.xml": AUX}, "dem.tif"),
    ".asc": ({"dem.asc": ASC, "dem.prj": PRJ}, "dem.asc"),
    ".hgt": ({"N46E008.hgt": HGT}, "N46E008.hgt"),
    ".vrt": ({"dem.tif": made_seeds.tiff(4, 1), "dem.vrt": VRT}, "dem.vrt"),
    "elevation raster": ({"a.json": made_seeds.text(RASTER), "dem.tif": made_seeds.tiff(4, 1)}, "a.json"),
    "scene .json": ({"a.json": made_seeds.scenes()[0], "model.gltf": made_seeds.text(made_seeds.square())}, "a.json"),
}
# Exports that docs/commands.md names, with the names of their formats.
EXPORTS = {"PLY": "ply", "NanoVDB": "nvdb", "OpenVDB": "vdb", "CesiumJS": "3dtiles", "GigaVoxels": "gigavoxel-xml",
           "LAS": "las"}


def meshopt():
    """Returns a document with an EXT_meshopt_compression fallback buffer, for which no file has data."""
    document = made_seeds.meshopt()
    document["buffers"][1]["extensions"] = {"EXT_meshopt_compression": {"fallback": True}}
    return document


# Compressed content of a glTF that docs/format-sources.md names.
COMPRESSED = {
    "KHR_draco_mesh_compression": made_seeds.draco(packed_seeds.DRACO_EDGEBREAKER),
    "EXT_meshopt_compression": meshopt(),
    "EXT_texture_webp": made_seeds.textured(packed_seeds.WEBP, "application/octet-stream", "EXT_texture_webp"),
}


class Formats(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.readme = (SOURCE / "README.md").read_text(encoding="utf-8")
        (cls.root / "square.glb").write_bytes(MODEL)
        PROGRAM.bake(cls.root / "square.glb", cls.root / "out", 0.1)

    def write(self, files):
        folder = Path(tempfile.mkdtemp(dir=self.root))
        for name, content in files.items():
            (folder / name).write_bytes(content)
        return folder

    # Regression of 2026-11-25: ./quickstart built a program that refused elevation rasters.
    def test_every_source_that_the_readme_names_is_read(self):
        sentence = re.search(r"`SOURCE` is (.*?)\(\[all of it\]", self.readme, re.S).group(1)
        named = set(re.findall(r"`(\.?[\w.]+)`", sentence)) - {".json"}
        self.assertLessEqual(named, set(SOURCES), "add the new format to SOURCES of this test")
        sentence = " ".join(sentence.replace("`", "").split())
        for name, (files, scene) in SOURCES.items():
            with self.subTest(source=name):
                self.assertIn(name, sentence)
                folder = self.write(files)
                result = PROGRAM.run("plan", folder / scene if scene else folder, "--voxel-size", 1, "--no-measure")
                self.assertEqual(result.returncode, 0, result.stderr)

    def test_every_compression_that_the_documentation_names_is_read(self):
        page = (SOURCE / "docs/format-sources.md").read_text(encoding="utf-8")
        for name, document in COMPRESSED.items():
            with self.subTest(extension=name):
                self.assertIn(name, page)
                scene = self.write({"a.gltf": made_seeds.text(document)}) / "a.gltf"
                PROGRAM.succeed("bake", scene, "-o", scene.parent / "out", "--voxel-size", 0.25)

    def test_every_export_that_the_documentation_names_is_written(self):
        commands = (SOURCE / "docs/commands.md").read_text(encoding="utf-8")
        names = re.search(r"^gigabake export .*?  +(.*)$", commands, re.M).group(1).split(", ")
        self.assertEqual(sorted(names), sorted(EXPORTS))
        for name in names:
            with self.subTest(export=name):
                target = self.root / EXPORTS[name]
                PROGRAM.succeed("export", self.root / "out", "--to", EXPORTS[name], "-o", target)
                self.assertTrue(target.exists())

    def test_the_window_and_the_modules_are_built_in(self):
        environment = {**harness.MPI_ENVIRONMENT, "PATH": "/usr/bin:/bin"}  # no display
        view = harness.run((PROGRAM.executable, "view", self.root / "out"), 60, env=environment)
        self.assertNotIn("built without", view.stderr)
        self.assertNotIn("not built in", re.search(r"(?m)^loaded .*", PROGRAM.succeed("--version")).group())


    @unittest.skipUnless(Path(sys.argv[1]).with_name("gigabake-bench").exists(), "gigabake-bench is not built")
    def test_the_reference_of_the_benchmarks_is_built_in(self):
        self.assertNotIn("built without", PROGRAM.run("bench", "query", self.root / "out").stderr)


class BuildPackages(unittest.TestCase):
    """Tests the packages that ./quickstart, cluster/Containerfile and a Debian package are built with."""

    def test_the_groups_have_every_library_that_cmake_looks_for(self):
        script = (SOURCE / "tools/install-packages").read_text(encoding="utf-8")
        groups = {name: set(re.search(rf'^{name}="(.*?)"', script, re.M | re.S).group(1).split())
                  for name in ("build", "bench")}
        for file in sorted((SOURCE / "cmake").glob("*.cmake")):
            if not file.name.startswith("install"):  # packages for users of the library, not for the build
                name = "bench" if file.name == "bench.cmake" else "build"
                named = set(re.findall(r"\blib[\w.+-]+-dev\b", file.read_text(encoding="utf-8")))
                self.assertLessEqual(named, groups[name], f"{file.name} names packages that the group {name} lacks")
        self.assertLessEqual({"libembree-dev", "libgmp-dev"}, groups["bench"] - groups["build"])
        self.assertIn("install-packages build\n", (SOURCE / "quickstart").read_text(encoding="utf-8"))
        self.assertIn("install-packages build ", (SOURCE / "cluster/Containerfile").read_text(encoding="utf-8"))

    def test_scripts_show_what_configure_prints_to_standard_error(self):
        for name in ("quickstart", "check"):
            for line in (SOURCE / name).read_text(encoding="utf-8").splitlines():
                if line.startswith("cmake --preset"):
                    self.assertNotRegex(line, r"2>|&>", name)

    def test_warnings_are_errors_in_the_presets_of_check(self):
        presets = json.loads((SOURCE / "CMakePresets.json").read_text(encoding="utf-8"))["configurePresets"]
        strict = {p["name"] for p in presets if p.get("cacheVariables", {}).get("GIGABAKE_WARNINGS_AS_ERRORS") == "ON"}
        self.assertEqual(strict, {"check", "asan", "tsan", "fuzz"})

    def test_configure_prints_one_line_for_a_library_that_is_missing(self):
        with tempfile.TemporaryDirectory() as folder:
            result = harness.run(("cmake", "-S", SOURCE, "-B", folder, "-G", "Ninja", "-DGIGABAKE_TESTS=OFF",
                                  "-DGIGABAKE_CUDA=OFF", "-DGB_GDAL_INCLUDE=", "-DGB_OPENVDB_INCLUDE=",
                                  "-DGB_IMGUI_INCLUDE=", "-DCMAKE_DISABLE_FIND_PACKAGE_OpenEXR=ON",
                                  "-DGIGABAKE_MPI=OFF"), 120)
            commands = (Path(folder) / "compile_commands.json").read_text(encoding="utf-8")
        self.assertEqual(result.returncode, 0, result.stderr)
        # Regression of 2026-11-25: a warning of a newer compiler stopped a user's build.
        self.assertNotIn("-Werror", commands)
        lines = [line for line in result.stderr.splitlines() if line.startswith("gigabake: ")]
        for package in ("libgdal-dev", "libopenvdb-dev", "libimgui-dev", "libopenexr-dev"):
            self.assertEqual(sum(package in line for line in lines), 1, result.stderr)

    def refused(self, *settings):
        """Returns the errors of a configuration that fails, on one line."""
        with tempfile.TemporaryDirectory() as folder:
            result = harness.run(("cmake", "-S", SOURCE, "-B", folder, "-G", "Ninja", "-DGIGABAKE_CUDA=OFF", *settings),
                                 120)
        self.assertNotEqual(result.returncode, 0)
        return " ".join(result.stderr.split())

    def test_configure_names_the_option_that_leaves_out_mpi(self):
        self.assertIn("-DGIGABAKE_MPI=OFF leaves out ranks", self.refused("-DCMAKE_DISABLE_FIND_PACKAGE_MPI=ON"))

    def test_configure_refuses_tests_without_what_they_need(self):
        self.assertIn("-DGIGABAKE_TESTS=OFF builds without them", self.refused("-DGIGABAKE_BENCH=OFF"))


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1], verbosity=2)
