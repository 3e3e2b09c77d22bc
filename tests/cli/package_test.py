#!/usr/bin/env python3
"""What is installed is whole: the program with its manual, a library that others' programs find, Debian packages.

Usage: package_test.py GIGABAKE SOURCE_DIR
"""
import gzip
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import harness

BUILD = Path(sys.argv[1]).resolve().parent
SOURCE = Path(sys.argv[2]).resolve()


def succeed(*command, **options):
    result = harness.run(command, 900, **options)
    assert result.returncode == 0, f"{command}: exit {result.returncode}\n{result.stdout}\n{result.stderr}"
    return result.stdout


class Package(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name)

    def expect_modules_load(self, prefix):
        """The installed program finds what it loads when it is needed: an error about the raster is GDAL's."""
        for module in BUILD.glob("gigabake-*.so"):
            self.assertTrue((prefix / "lib/gigabake" / module.name).exists(), module)
        if list(BUILD.glob("gigabake-gdal-*.so")):
            (self.path / "none.tif").write_bytes(b"no raster")
            told = subprocess.run([prefix / "bin/gigabake", "plan", self.path / "none.tif", "--voxel-size", "1"],
                                  capture_output=True, text=True, timeout=60, check=False)
            self.assertIn("expected a GeoTIFF", told.stderr)

    def install(self):
        prefix = self.path / "prefix"
        succeed("cmake", "--install", BUILD, "--prefix", prefix)
        return prefix

    def test_the_installed_program_runs_and_has_a_manual_and_completion(self):
        prefix = self.install()
        self.assertIn("gigabake", succeed(prefix / "bin/gigabake", "--version"))
        self.expect_modules_load(prefix)
        page = gzip.decompress((prefix / "share/man/man1/gigabake-bake.1.gz").read_bytes()).decode()
        self.assertIn("voxel\\-size", page)
        for file in ("bash-completion/completions/gigabake", "zsh/vendor-completions/_gigabake",
                     "fish/vendor_completions.d/gigabake.fish"):
            self.assertIn("gigabake export", (prefix / "share" / file).read_text())

    def test_anothers_program_finds_the_libraries_and_reads_a_shard(self):
        prefix = self.install()
        build = self.path / "consumer"
        succeed("cmake", "-S", SOURCE / "tests/package/consumer", "-B", build, "-G", "Ninja",
                f"-DCMAKE_PREFIX_PATH={prefix}")
        succeed("cmake", "--build", build)
        program = harness.Gigabake(sys.argv[1])
        program.succeed("sample", self.path / "village", "--size", "64", "--seed", "3")
        info = program.bake(self.path / "village/tileset.json", self.path / "bake", 0.5)
        for lod in (0, 2):
            voxels = [int(succeed(build / "consumer", shard, lod))
                      for shard in (self.path / "bake/shards").glob("*.h5")]
            self.assertEqual(sum(voxels), info["lods"][lod]["voxels"])

    def test_headers_that_are_installed_include_only_what_is_installed(self):
        include = self.install() / "include/gigabake"
        headers = list(include.rglob("*.h"))
        self.assertGreater(len(headers), 50)
        for header in headers:
            for line in header.read_text().splitlines():
                if line.startswith('#include "'):
                    self.assertTrue((include / line.split('"')[1]).exists(), f"{header}: {line}")

    @unittest.skipUnless(shutil.which("cpack") and shutil.which("dpkg-shlibdeps"), "cpack or dpkg-dev is not installed")
    def test_debian_packages_have_the_files_and_name_the_libraries(self):
        pack = ["cpack", "-G", "DEB", "--config", BUILD / "CPackConfig.cmake", "-B", self.path / "packages"]
        # 2026-11-22: packages had a maintainer at a host that does not exist.
        nobody = {name: value for name, value in os.environ.items() if name not in ("DEBFULLNAME", "DEBEMAIL")}
        refused = harness.run(pack, 900, cwd=self.path, env=nobody)
        self.assertNotEqual(refused.returncode, 0)
        self.assertIn("set DEBFULLNAME and DEBEMAIL", refused.stderr)
        packer = {"DEBFULLNAME": "Package Test", "DEBEMAIL": "packager@example.com"}
        succeed(*pack, cwd=self.path, env={**nobody, **packer})
        packages = sorted(p.name.split("_")[0] for p in (self.path / "packages").glob("*.deb"))
        self.assertEqual(packages, ["gigabake", "gigabake-dev"])
        program, = (self.path / "packages").glob("gigabake_*.deb")
        control = succeed("dpkg-deb", "-I", program)
        self.assertIn("Maintainer: Package Test <packager@example.com>", control)
        for library in ("libhdf5-", "liblz4-1", "libopenmpi3", "libc6"):
            self.assertIn(library, control)
        files = succeed("dpkg-deb", "-c", program)
        for file in ("./usr/bin/gigabake", "./usr/share/man/man1/gigabake-export.1.gz",
                     "./usr/share/bash-completion/completions/gigabake", "./usr/share/doc/gigabake/copyright"):
            self.assertIn(file, files)
        self.assertNotIn(".a\n", files)
        development, = (self.path / "packages").glob("gigabake-dev_*.deb")
        files = succeed("dpkg-deb", "-c", development)
        for file in ("lib/libgigabake_format.a", "include/gigabake/format/shard_reader.h", "gigabakeConfig.cmake"):
            self.assertIn(file, files)
        unpacked = self.path / "unpacked"
        succeed("dpkg-deb", "-x", program, unpacked)
        self.assertIn("gigabake", succeed(unpacked / "usr/bin/gigabake", "--version"))
        self.expect_modules_load(unpacked / "usr")
        if shutil.which("lintian"):
            told = subprocess.run(["lintian", "--fail-on", "none", program, development], capture_output=True,
                                  text=True, timeout=600, check=False, env=dict(os.environ, LC_ALL="C.UTF-8"))
            print(told.stdout)
            self.assertEqual([line for line in told.stdout.splitlines() if line.startswith("E:")], [])


if __name__ == "__main__":
    harness.main(argv=sys.argv[:1], verbosity=2)
