#!/usr/bin/env python3
"""Random edits of voxels and of sources, batches, undos, ranks, cell sizes and kills: after each step, a scene equals a
bake from nothing with the same lists, also with cells of another size.

Usage: edit_random_test.py GIGABAKE SOURCE_DIR [--edits N] [--seed S]

The default runs in a minute. The long run, of some hours on two cores: --edits 2000
"""
import json
import math
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness
from edit_cases import VOXEL_M, random_edit, write_ground

CELLS = (16, 32, 64)
STEPS_PER_SCENE = 12


def random_source_edit(rng):
    """Returns an edit of the ground by a polygon, without its own crossings."""
    count, x, y = rng.randrange(3, 8), rng.uniform(-5, 5), rng.uniform(-5, 5)
    turns = [2 * math.pi * (i + rng.uniform(0, 0.7)) / count for i in range(count)]
    ring = [[x + (r := rng.uniform(2, 7)) * math.cos(t), y + r * math.sin(t)] for t in turns]
    edit = {"type": rng.choice(("outside", "flatten", "raise")), "rings_m": [ring]}
    if edit["type"] == "flatten":
        edit["height_m"] = rng.uniform(-3, 3)
    if edit["type"] == "raise":
        edit["by_m"] = rng.uniform(-3, 3)
    return edit


class Scene:
    """A scene under test, and the lists of edits that it should have."""

    def __init__(self, root, rng):
        self.folder, self.rng = Path(tempfile.mkdtemp(dir=root)), rng
        self.out, self.source = self.folder / "out", self.folder / "scene.json"
        self.cell, self.edits, self.source_edits = rng.choice(CELLS), [], []
        self.source_class = rng.choice((None, 2))
        write_ground(self.folder / "ground.glb")
        self.bake(self.out, self.cell, [])

    def write_source(self, path, edits):
        entry = {"path": "ground.glb", "place": {"position_m": [0, 0, 0]}, "edits": self.source_edits}
        if self.source_class is not None:
            entry["class"] = self.source_class
        path.write_text(json.dumps({"gigabake": 1, "sources": [entry], "edits": edits}))

    def bake(self, out, cell, edits):
        source = self.source if out == self.out else self.folder / "nothing.json"
        self.write_source(source, edits)
        PROGRAM.succeed("bake", source, "-o", out, "--voxel-size", VOXEL_M, "--cell-voxels", cell, "--threads", 2, "-q",
                        ranks=self.rng.choice((None, None, 2)))

    def hashes(self, out):
        return harness.lod_hashes(PROGRAM.info(out / "scene.xml"))

    def expect_whole(self):
        """Compares the scene with a bake from nothing, whose cells may have another size."""
        nothing = Path(tempfile.mkdtemp(dir=self.folder)) / "out"
        self.bake(nothing, self.rng.choice(CELLS), self.edits)
        ours, theirs = self.hashes(self.out), self.hashes(nothing)
        common = min(len(ours), len(theirs))
        listed = json.loads(PROGRAM.succeed("edit", self.out, "--list", "--json"))["edits"]
        return listed == self.edits and common >= 3 and ours[:common] == theirs[:common]

    def batch(self):
        new = [random_edit(self.rng) for _ in range(self.rng.randrange(1, 6))]
        for edit in new:  # the first class of a scene changes all of its cells
            if edit["type"] != "carve" and self.rng.random() < (0.05 if self.source_class is None else 0.5):
                edit["class"] = self.rng.randrange(4)
        file = self.folder / "batch.json"
        file.write_text(json.dumps({"edits": new}))
        return file, new

    def edit(self):
        file, new = self.batch()
        PROGRAM.succeed("edit", self.out, "--from", file, "-q", ranks=self.rng.choice((None, None, 2, 3)))
        self.edits += new
        return len(new)

    def undo(self):
        for _ in range(self.rng.randrange(1, 4)):
            if self.edits:
                PROGRAM.succeed("edit", self.out, "--undo", "-q")
                self.edits.pop()
        return 0

    def edit_source(self):
        if self.source_edits and self.rng.random() < 0.3:
            self.source_edits.pop()
        else:
            self.source_edits.append(random_source_edit(self.rng))
        self.bake(self.out, self.cell, [])
        return 1

    def kill(self):
        """Kills an edit; it has happened as a whole, or not at all. Then it is repeated or resumed."""
        file, new = self.batch()
        command = [PROGRAM.executable, "edit", self.out, "--from", file, "-q"]
        with subprocess.Popen(list(map(str, command)), stderr=subprocess.DEVNULL, start_new_session=True) as run:
            time.sleep(self.rng.uniform(0.02, 0.5))
            os.killpg(run.pid, signal.SIGKILL)
        found = json.loads(PROGRAM.succeed("edit", self.out, "--list", "--json"))["edits"]
        assert found in (self.edits, self.edits + new), (found, self.edits, new)
        if found == self.edits:
            PROGRAM.succeed("edit", self.out, "--from", file, "-q")
        else:
            self.bake(self.out, self.cell, [])
        self.edits += new
        return len(new)

    def prune(self):
        """Removes the shards of earlier edits, so that an undo has to find another way."""
        self.write_source(self.source, [])
        PROGRAM.succeed("bake", self.source, "-o", self.out, "--voxel-size", VOXEL_M, "--cell-voxels", self.cell,
                        "--prune", "-q")
        return 0


class RandomEdits(harness.FolderTest):
    def test_each_step_equals_a_bake_from_nothing(self):
        rng, done, steps = random.Random(SEED), 0, 0
        while done < EDITS:
            scene = Scene(self.root, rng)
            for _ in range(STEPS_PER_SCENE):
                step = rng.choice((scene.edit, scene.edit, scene.edit, scene.undo, scene.edit_source, scene.kill,
                                   scene.prune))
                done += step()
                steps += 1
                self.assertTrue(scene.expect_whole(), (SEED, steps, step.__name__, scene.out))
                if done >= EDITS:
                    break
            PROGRAM.succeed("verify", scene.out)
            print(f"{done} edits in {steps} steps", flush=True)


def number(option, default):
    return int(sys.argv[sys.argv.index(option) + 1]) if option in sys.argv else default


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(Path(sys.argv[1]).resolve())
    EDITS, SEED = number("--edits", 30), number("--seed", 20261128)
    harness.main(argv=sys.argv[:1], verbosity=2)
