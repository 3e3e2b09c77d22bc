#!/usr/bin/env python3
"""The example examples/shard_in_python.py reads a real shard, and its output agrees with `gigabake info`.

Usage: python_example_test.py GIGABAKE SOURCE_DIR
"""
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from h5py_there import h5py, numpy

try:
    import matplotlib.image
except ImportError as error:
    print(f"skipped: {error} (python3-matplotlib)")
    sys.exit(77)

import harness

EXAMPLE = Path(sys.argv[2]) / "examples/shard_in_python.py"


class PythonExample(unittest.TestCase):
    def test_draws_each_level_and_says_what_info_says(self):
        program = harness.Gigabake(sys.argv[1])
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            program.succeed("sample", folder / "village", "--size", "96", "--seed", "3")
            info = program.bake(folder / "village/tileset.json", folder / "bake", 0.5)
            shards = sorted((folder / "bake/shards").glob("c_*.h5"))
            for lod in (0, 1):
                voxels = 0
                for shard in shards:
                    picture = folder / f"{shard.stem}.png"
                    result = subprocess.run(["/usr/bin/python3", EXAMPLE, shard, str(lod), picture], check=True,
                                            capture_output=True, text=True, timeout=300)
                    voxels += int(re.search(r"(\d+) voxels in", result.stdout).group(1))
                    pixels = matplotlib.image.imread(picture)
                    self.assertGreater(len(numpy.unique(pixels.reshape(-1, pixels.shape[-1]), axis=0)), 20)
                self.assertEqual(voxels, info["lods"][lod]["voxels"])


if __name__ == "__main__":
    harness.main(argv=sys.argv[:1], verbosity=2)
