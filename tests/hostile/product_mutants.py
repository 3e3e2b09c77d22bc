#!/usr/bin/env python3
"""Mutants of the files of a bake: scene.xml, shards, journal, scan cache, status. On each mutant no command crashes,
hangs or prints an endless line; a scene that verify calls whole has the voxels of the bake; and a repeated bake ends
with these voxels.

Usage: product_mutants.py GIGABAKE SOURCE_DIR [--count N] [--seed S] [--keep FOLDER]
"""
import json
import random
import shutil
import sys
import tempfile
from pathlib import Path

import numpy

import hostile_run
import product_edits

VOXEL_M, CELL_VOXELS = 0.5, 32
# Regressions of 2026-11-22: an edited shard was reused; names of files, fingerprints and channels were unlimited.
FOUND = [105, 100503, 100807, 101120]


def rolling_ground(quads, phase):
    grid = numpy.arange(quads + 1) * 0.8
    x, z = numpy.meshgrid(grid, grid)
    positions = numpy.stack([x, 2 * numpy.sin(x / 3 + phase) * numpy.cos(z / 4), -z], -1).reshape(-1, 3)
    corner = (numpy.arange(quads)[:, None] * (quads + 1) + numpy.arange(quads)).reshape(-1)
    next_row = corner + quads + 1
    indices = numpy.stack([corner, corner + 1, next_row, corner + 1, next_row + 1, next_row], -1)
    colours = numpy.random.default_rng(7).integers(0, 256, (len(positions), 4))
    colours[:, 3] = 255
    return positions, indices, colours


class Bake:
    """A small scene of several cells, its voxels, and the command that baked it."""

    def __init__(self, program, root):
        self.program, self.root = program, root
        self.options = ("--voxel-size", VOXEL_M, "--cell-voxels", CELL_VOXELS, "--threads", 1, "--backend", "cpu")
        for name, phase in (("whole", 0), ("other", 1)):
            hostile_run.harness.write_glb(root / f"{name}.glb", *rolling_ground(40, phase))
            self.succeed("bake", root / f"{name}.glb", "-o", root / name, *self.options)
        self.out = root / "whole"
        self.lods = CELL_VOXELS.bit_length() - 3  # levels of cells, which exports have; overview levels are hashed
        self.hashes = self.hashes_of(self.out)
        self.voxels = [self.ply(self.out, lod) for lod in range(self.lods)]

    def succeed(self, *arguments):
        ended = self.program.run(*arguments, seconds=300)
        assert ended.returncode == 0, (arguments, ended.returncode, ended.stdout, ended.stderr)
        return ended.stdout

    def hashes_of(self, out):
        info = json.loads(self.succeed("info", out, "--json"))
        return [(lod["voxels"], lod["content_hash"]) for lod in info["lods"]] + [info["content_hash"]]

    def ply(self, out, lod):
        self.succeed("export", out, "--to", "ply", "--lod", lod, "-o", self.root / "voxels.ply")
        return hostile_run.harness.read_ply(self.root / "voxels.ply").tobytes()


class Judge:
    """Runs every command on a mutant and collects faults."""

    def __init__(self, bake):
        self.bake, self.named, self.whole = bake, 0, 0

    def faults_of(self, mutant, edit):
        faults = []

        def run(*arguments):
            ended = self.bake.program.run(*arguments)
            faults.extend(ended.faults())
            return ended

        verified = run("verify", mutant)
        is_whole = verified.returncode == 0
        self.named, self.whole = self.named + (not is_whole), self.whole + is_whole
        # In a scene of an old version, verify reports that it cannot detect a lost cell.
        is_right = is_whole and not (edit.loses_cells and "has no summary" in verified.stdout)
        info = run("info", mutant, "--json")
        if is_right and (info.returncode != 0 or self.hashes_in(info) != self.bake.hashes):
            faults.append("verify calls it whole, but info prints other voxels")
        faults += self.wrong_exports(mutant, is_right, run)
        different = run("diff", self.bake.out, mutant)
        if is_right and different.returncode != 0:
            faults.append("verify calls it whole, but diff reports a difference")
        run("render", mutant, "-o", self.bake.root / "picture.png", "--size", "48x32", "--backend", "cpu")
        return faults + self.wrong_after_another_bake(mutant, edit, run)

    def hashes_in(self, info):
        answer = json.loads(info.stdout)
        return [(lod["voxels"], lod["content_hash"]) for lod in answer["lods"]] + [answer["content_hash"]]

    def wrong_exports(self, mutant, is_right, run):
        for lod in range(self.bake.lods if is_right else 1):
            ply = self.bake.root / "mutant.ply"
            ply.unlink(missing_ok=True)
            exported = run("export", mutant, "--lod", lod, "-o", ply)
            if exported.returncode != 0:
                if ply.exists():
                    return [f"export of lod {lod} fails and leaves a file"]
                if is_right:
                    return [f"verify calls it whole, but lod {lod} cannot be exported: {exported.stderr}"]
                continue
            is_same = hostile_run.harness.read_ply(ply).tobytes() == self.bake.voxels[lod]
            if is_right and not is_same:
                return [f"verify calls it whole, but lod {lod} has other voxels"]
        return []

    def wrong_after_another_bake(self, mutant, edit, run):
        again = run("bake", self.bake.root / "whole.glb", "-o", mutant, *self.bake.options)
        if edit.bars_baking and again.returncode != 0:
            return []
        if again.returncode != 0:
            return [f"bake again fails: exit {again.returncode} {again.stderr}"]
        verified = run("verify", mutant)
        if verified.returncode != 0:
            return [f"a repeated bake does not fix it: {verified.stdout}{verified.stderr}"]
        try:
            voxels = self.bake.ply(mutant, 0)
        except AssertionError as error:
            return [f"bake again leaves what cannot be exported: {error}"]
        if self.bake.hashes_of(mutant) != self.bake.hashes or voxels != self.bake.voxels[0]:
            return ["bake again ends with other voxels"]
        return []


def main():
    options = hostile_run.arguments(__doc__, 12, 20261122)
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        bake = Bake(hostile_run.LimitedProgram(options.gigabake), root)
        judge, kept = Judge(bake), hostile_run.Kept(options.keep)
        seeds = FOUND + list(range(options.seed, options.seed + options.count))
        for seed in seeds:
            mutant = root / "mutant"
            shutil.rmtree(mutant, ignore_errors=True)
            shutil.copytree(bake.out, mutant)
            edit = product_edits.edit(random.Random(seed), mutant, root / "other")
            before = root / "kept"
            shutil.rmtree(before, ignore_errors=True)
            shutil.copytree(mutant, before, symlinks=True)
            faults = judge.faults_of(mutant, edit)
            if faults:
                kept.keep(f"product_{seed}", before, [edit.what, *faults])
    print(f"{len(seeds)} mutants from seed {options.seed} on: verify names {judge.named}, calls {judge.whole} "
          f"whole; {kept.count} went wrong")
    return 1 if kept.count else 0


if __name__ == "__main__":
    sys.exit(main())
