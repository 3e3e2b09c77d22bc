#!/usr/bin/env python3
"""Tests the installation: the program with its manual, a library that other programs find, and Debian packages.

Usage: package_test.py GIGABAKE SOURCE_DIR
"""
import gzip
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

BUILD = Path(sys.argv[1]).resolve().parent
SOURCE = Path(sys.argv[2]).resolve()


def succeed(*command, **options):
    result = harness.run(command, 900, **options)
    assert result.returncode == 0, f"{command}: exit {result.returncode}\n{result.stdout}\n{result.stderr}"
    return result.stdout


class Package(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.prefix = cls.root / "prefix"
        succeed("cmake", "--install", BUILD, "--prefix", cls.prefix)
        program = harness.Gigabake(sys.argv[1])
        program.succeed("sample", cls.root / "village", "--size", "64", "--seed", "3")
        cls.baked = program.bake(cls.root / "village/tileset.json", cls.root / "bake", 0.5)

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name)

    def expect_modules_load(self, prefix):
        """Checks that the installed program finds the modules that it loads on demand: GDAL reports the bad raster."""
        for module in BUILD.glob("gigabake-*.so"):
            self.assertTrue((prefix / "lib/gigabake" / module.name).exists(), module)
        if list(BUILD.glob("gigabake-gdal-*.so")):
            (self.path / "none.tif").write_bytes(b"no raster")
            told = subprocess.run([prefix / "bin/gigabake", "plan", self.path / "none.tif", "--voxel-size", "1"],
                                  capture_output=True, text=True, timeout=60, check=False)
            self.assertIn("expected a GeoTIFF", told.stderr)

    def test_the_installed_program_runs_and_has_a_manual_and_completion(self):
        self.assertIn("gigabake", succeed(self.prefix / "bin/gigabake", "--version"))
        self.expect_modules_load(self.prefix)
        page = gzip.decompress((self.prefix / "share/man/man1/gigabake-bake.1.gz").read_bytes()).decode()
        self.assertIn("voxel\\-size", page)
        for file in ("bash-completion/completions/gigabake", "zsh/vendor-completions/_gigabake",
                     "fish/vendor_completions.d/gigabake.fish"):
            self.assertIn("gigabake export", (self.prefix / "share" / file).read_text())

    def build(self, name, *settings):
        """Builds an example in C++ against the installed library. Returns its build folder."""
        build = self.path / name
        succeed("cmake", "-S", SOURCE / "examples" / name, "-B", build, "-G", "Ninja",
                f"-DCMAKE_PREFIX_PATH={self.prefix}", *settings)
        succeed("cmake", "--build", build)
        return build / name

    def test_anothers_program_reads_shards_and_links_little_else(self):
        reader = self.build("read_shard", *(f"-DCMAKE_DISABLE_FIND_PACKAGE_{package}=ON"
                                              for package in ("JPEG", "OpenEXR", "PNG", "ZLIB")))
        needed = re.findall(r"\(NEEDED\).*\[(.+?)\.so", succeed("readelf", "-d", reader))
        print("a reader of shards links", *needed)
        self.assertLessEqual(len(needed), 8)
        self.assertTrue(set(needed) <= {"libhdf5_serial", "libhdf5", "liblz4", "libdeflate", "libfmt", "libstdc++",
                                        "libgcc_s", "libm", "libc", "ld-linux-x86-64", "ld-linux-aarch64"}, needed)
        for lod in (0, 2):
            voxels = [int(succeed(reader, shard, lod)) for shard in (self.root / "bake/shards").glob("c_*.h5")]
            self.assertEqual(sum(voxels), self.baked["lods"][lod]["voxels"])

    def test_anothers_program_bakes_exports_and_draws(self):
        program = self.build("bake_terrain")
        # Regression of 2026-11-22: the folder was read from a variable that other packages also set.
        self.assertIn(str(self.prefix / "lib/gigabake"), succeed("readelf", "-d", program))
        baked, exported, drawn = map(int, succeed(
            program, self.root / "village/tileset.json", self.root / "bake/scene.xml", self.path / "village.ply",
            self.path / "village.png").split())
        self.assertGreater(baked, 0.9 * self.baked["lods"][0]["voxels"])
        self.assertEqual(exported, self.baked["lods"][0]["voxels"])
        self.assertGreater(drawn, 64)
        self.assertEqual((self.path / "village.png").read_bytes()[:4], b"\x89PNG")

    def test_the_viewers_examples_draw(self):
        cut_open = self.build("viewer").parent / "cut_open"
        made, pixels = map(int, succeed(cut_open.parent / "procedural_ground", self.path / "waves.png").split())
        self.assertEqual(made, 2 * 24 * 24)
        self.assertGreater(pixels, 96 * 96 / 8)
        scene = self.root / "bake/scene.xml"
        whole, half, height = succeed(cut_open, scene, self.path / "cut.png").split()
        self.assertGreater(int(half), 0.3 * int(whole))
        self.assertLess(int(half), 0.7 * int(whole))
        told = harness.Gigabake(sys.argv[1]).succeed("query", scene, "--at", "0,0").splitlines()[1].split(",")
        self.assertAlmostEqual(float(told[4]), float(height), delta=1e-3)
        surface, lines = map(int, succeed(cut_open.parent / "contour_lines", scene, 2, self.path / "lines.png").split())
        self.assertGreater(surface, 1000)
        self.assertGreater(lines, 0.01 * surface)
        self.assertLess(lines, 0.5 * surface)

    def test_a_room_that_is_not_installed_is_named(self):
        (self.path / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.22)\nproject(x LANGUAGES CXX)\n"
                                                  "find_package(gigabake REQUIRED COMPONENTS shard attic)\n")
        told = harness.run(("cmake", "-S", self.path, "-B", self.path / "build",
                            f"-DCMAKE_PREFIX_PATH={self.prefix}"), 100)
        self.assertNotEqual(told.returncode, 0)
        self.assertIn("attic", told.stderr)

    def test_the_headers_that_are_listed_are_installed_and_include_only_each_other(self):
        include = self.prefix / "include/gigabake"
        headers = sorted(header.relative_to(include).as_posix() for header in include.rglob("*.*"))
        listed = re.findall(r"^ +([\w/]+\.(?:h|cuh)\b)", (SOURCE / "cmake/public_headers.cmake").read_text(), re.M)
        self.assertEqual(headers, sorted(listed))
        for header in headers:
            for line in (include / header).read_text().splitlines():
                if line.startswith('#include "'):
                    self.assertIn(line.split('"')[1], listed, f"{header}: {line}")
        everything = self.path / "everything.cpp"
        # Headers for nvcc need CUDA's headers and are not compiled.
        everything.write_text("".join(f"#include <{header}>\n" for header in headers if header.endswith(".h")))
        succeed(os.environ.get("CXX", "c++"), "-std=c++20", "-fsyntax-only", "-I", include, everything)

    @unittest.skipUnless(shutil.which("cpack") and shutil.which("dpkg-shlibdeps"), "cpack or dpkg-dev is not installed")
    def test_debian_packages_have_the_files_and_name_the_libraries(self):
        pack = ["cpack", "-G", "DEB", "--config", BUILD / "CPackConfig.cmake", "-B", self.path / "packages"]
        # Regression of 2026-11-22: packages named a maintainer at a host that does not exist.
        nobody = {name: value for name, value in os.environ.items() if name not in ("DEBFULLNAME", "DEBEMAIL")}
        refused = harness.run(pack, 900, cwd=self.path, env=nobody)
        self.assertNotEqual(refused.returncode, 0)
        self.assertIn("set DEBFULLNAME and DEBEMAIL", refused.stderr)
        packer = {"DEBFULLNAME": "Package Test", "DEBEMAIL": "packager@example.com"}
        succeed(*pack, cwd=self.path, env={**nobody, **packer})
        packages = sorted(p.name.split("_")[0] for p in (self.path / "packages").glob("*.deb"))
        self.assertEqual(packages, ["gigabake", "gigabake-bench", "gigabake-dev"])
        program, = (self.path / "packages").glob("gigabake_*.deb")
        control = succeed("dpkg-deb", "-I", program)
        self.assertIn("Maintainer: Package Test <packager@example.com>", control)
        for library in ("libhdf5-", "liblz4-1", "libopenmpi3", "libc6"):
            self.assertIn(library, control)
        for library in ("embree", "gmp"):
            self.assertNotIn(library, control)
        files = succeed("dpkg-deb", "-c", program)
        for file in ("./usr/bin/gigabake", "./usr/share/man/man1/gigabake-export.1.gz",
                     "./usr/share/bash-completion/completions/gigabake", "./usr/share/doc/gigabake/copyright"):
            self.assertIn(file, files)
        self.assertNotIn(".a\n", files)
        self.assertNotIn("/gigabake-bench\n", files)
        development, = (self.path / "packages").glob("gigabake-dev_*.deb")
        files = succeed("dpkg-deb", "-c", development)
        for file in ("lib/libgigabake_shard.a", "include/gigabake/format/shard/shard_reader.h", "gigabakeConfig.cmake"):
            self.assertIn(file, files)
        unpacked = self.path / "unpacked"
        succeed("dpkg-deb", "-x", program, unpacked)
        self.assertIn("gigabake", succeed(unpacked / "usr/bin/gigabake", "--version"))
        self.expect_modules_load(unpacked / "usr")
        benchmarks, = (self.path / "packages").glob("gigabake-bench_*.deb")
        succeed("dpkg-deb", "-x", benchmarks, unpacked)
        self.assertIn("dispatches/s", succeed(unpacked / "usr/bin/gigabake", "bench", "schedule", "--cells", "20"))
        if shutil.which("lintian"):
            told = subprocess.run(["lintian", "--fail-on", "none", program, development, benchmarks],
                                  capture_output=True, text=True, timeout=600, check=False,
                                  env=dict(os.environ, LC_ALL="C.UTF-8"))
            print(told.stdout)
            self.assertEqual([line for line in told.stdout.splitlines() if line.startswith("E:")], [])


if __name__ == "__main__":
    harness.main(argv=sys.argv[:1], verbosity=2)
