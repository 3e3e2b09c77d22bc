#!/usr/bin/env python3
"""`edit` changes a baked scene: afterwards, it equals a bake from nothing with the same list of edits.

Usage: edit_test.py GIGABAKE SOURCE_DIR [--rounds N]
"""
import json
import os
import random
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness
from edit_cases import VOXEL_M, random_edit, scene_file, write_ground

OPTIONS = ("--cell-voxels", 16, "--threads", 2, "-q")


def shape_option(edit):
    """Returns the options of `edit` for an edit without a prism."""
    if "box" in edit:
        shape = "box:" + ",".join(map(repr, edit["box"]["min_m"] + edit["box"]["max_m"]))
    else:
        name = "sphere" if "sphere" in edit else "cylinder"
        values = edit[name]
        numbers = [*values["position_m"], values["radius_m"], *([values["height_m"]] if name == "cylinder" else [])]
        shape = f"{name}:" + ",".join(map(repr, numbers))
    options = [f"--{edit['type']}={shape}"]
    if "rgb" in edit:
        options.append("--rgb=" + ",".join(map(str, edit["rgb"])))
    if "alpha" in edit:
        options.append(f"--alpha={edit['alpha']}")
    return options


def shards(folder):
    text = (Path(folder) / "scene.xml").read_text(encoding="utf-8")
    return set(re.findall(r"shards/[cp][-\d_]*-[0-9a-f]{32}\.h5", text))


def chose_device(report):
    """Returns whether a bake process chose its device, with or without success."""
    return report["ranks_with_device"] > 0 or "no_device" in report


class Edit(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        write_ground(cls.root / "ground.glb")

    def setUp(self):
        self.scene = self.root / self._testMethodName
        self.source = scene_file(self.root / f"{self._testMethodName}.json", [])
        PROGRAM.succeed("bake", self.source, "-o", self.scene, "--voxel-size", VOXEL_M, *OPTIONS)

    def hash_of(self, folder):
        return harness.lod_hashes(PROGRAM.info(folder / "scene.xml"))

    def hash_from_nothing(self, edits):
        out = self.root / f"nothing{time.time_ns()}"
        source = scene_file(self.root / "nothing.json", edits)
        PROGRAM.succeed("bake", source, "-o", out, "--voxel-size", VOXEL_M, *OPTIONS)
        return self.hash_of(out)

    def listed(self):
        return json.loads(PROGRAM.succeed("edit", self.scene, "--list", "--json"))["edits"]

    def expect_state(self, edits):
        self.assertEqual(self.listed(), edits)
        self.assertEqual(self.hash_of(self.scene), self.hash_from_nothing(edits))

    def fail_with(self, status, *arguments, text):
        before = self.hash_of(self.scene), self.listed()
        result = PROGRAM.run("edit", self.scene, *arguments)
        self.assertEqual(result.returncode, status, result)
        lines = [line for line in result.stderr.splitlines() if line.startswith("gigabake: ")]
        self.assertEqual(len(lines), 1, result.stderr)
        self.assertIn(text, lines[0])
        self.assertEqual((self.hash_of(self.scene), self.listed()), before)

    def test_batches_and_undos_equal_bakes_from_nothing(self):
        for seed in range(ROUNDS):
            with self.subTest(seed=seed):
                rng = random.Random(1000 + seed)
                edits = self.listed()
                batch = [random_edit(rng) for _ in range(rng.randrange(1, 4))]
                file = self.root / "batch.json"
                file.write_text(json.dumps({"edits": batch}))
                ranks = rng.choice((None, 2, 3))
                PROGRAM.succeed("edit", self.scene, "--from", file, "-q", ranks=ranks)
                edits += batch
                self.expect_state(edits)
                for _ in range(rng.randrange(0, len(batch) + 1)):
                    PROGRAM.succeed("edit", self.scene, "--undo", "-q")
                    edits.pop()
                self.expect_state(edits)

    def test_shapes_on_the_command_line(self):
        rng, edits = random.Random(3), []
        while len(edits) < 8:
            edit = random_edit(rng)
            if "prism" in edit:
                continue
            PROGRAM.succeed("edit", self.scene, *shape_option(edit), "-q")
            edits.append(edit)
        self.expect_state(edits)

    def test_only_changed_cells_are_baked_and_others_keep_their_files(self):
        before = shards(self.scene)
        report = json.loads(PROGRAM.succeed("edit", self.scene, "--paint=sphere:4,4,0,1.5", "--rgb=1,2,3", "--json"))
        after = shards(self.scene)
        changed = {name for name in after - before if "/c_" in name}
        self.assertTrue(changed and all("/c_0_0_" in name for name in changed), changed)
        self.assertEqual(report["cells_taken_over"], len([n for n in before if "/c_" in n]) - len(changed))
        self.assertFalse(chose_device(report), "an edit in place needs no device")
        report = json.loads(PROGRAM.succeed("edit", self.scene, "--undo", "--json"))
        self.assertFalse(chose_device(report), "an undo needs no device")
        self.assertEqual(shards(self.scene), before)
        self.assertFalse((self.scene / "edits.json").exists())

    def test_a_small_edit_builds_few_bricks_whatever_the_size_of_the_scene(self):
        for members in ({}, {"class": 2}):
            with self.subTest(members):
                self.expect_few_bricks(members)

    def expect_few_bricks(self, members):
        work = []
        for copies in (1, 5):
            places = [{"path": "ground.glb", "place": {"position_m": [100 * x, 0, 0]}, **members}
                      for x in range(copies)]
            name = f"size{copies}{''.join(members)}"
            source, out = self.root / f"{name}.json", self.root / name
            source.write_text(json.dumps({"gigabake": 1, "sources": places}))
            PROGRAM.succeed("bake", source, "-o", out, "--voxel-size", VOXEL_M, *OPTIONS, "--no-overviews")
            reports = [json.loads(PROGRAM.succeed("edit", out, option, "--rgb=1,2,3", "--json"))
                       for option in ("--paint=sphere:2,2,2,1.2", "--fill=box:2,2,2,3,3,5")]
            work.append([(r["run"]["work"]["edited_bricks"], r["run"]["work"]["shard_bytes_written"],
                          r["run"]["work"]["shard_bytes_copied"], r["run"]["work"]["file_bytes_read"])
                         for r in reports])
        self.assertEqual(work[0], work[1])
        for bricks, written, copied, read in work[0]:
            self.assertTrue(0 < bricks <= 4 * 2 * 8 and copied <= written and read == 0, work[0])

    def test_an_undo_loads_no_driver_of_a_gpu(self):
        fill = shape_option({"type": "fill", "sphere": {"position_m": [0, 0, 0], "radius_m": 1}, "rgb": [1, 2, 3]})
        PROGRAM.succeed("edit", self.scene, *fill, "-q")
        # An OpenCL loader tries the driver that each file of this folder names.
        (self.root / "drivers").mkdir()
        (self.root / "drivers/gpu.icd").write_text("libdriver_of_this_test.so\n", encoding="utf-8")
        environment = {key: value for key, value in os.environ.items() if key != "HWLOC_COMPONENTS"}
        environment |= {"OCL_ICD_VENDORS": str(self.root / "drivers"), "LD_DEBUG": "libs"}
        loaded = subprocess.run([PROGRAM.executable, "edit", self.scene, "--undo", "-q"], capture_output=True,
                                text=True, timeout=300, env=environment, check=True).stderr
        self.assertIn("libmpi", loaded)
        self.assertNotIn("libdriver_of_this_test", loaded)
        self.assertNotIn("libcuda.so", loaded)

    def test_rows_that_move_are_unpacked_once(self):
        out = self.root / "fine"
        PROGRAM.succeed("bake", scene_file(self.root / "fine.json", []), "-o", out, "--voxel-size", 1 / 32,
                        "--cell-voxels", 1024, "--no-overviews")
        report = json.loads(PROGRAM.succeed("edit", out, "--fill=box:-11,-11,-1,-10,-10,3", "--rgb=1,2,3", "--json"))
        work = report["run"]["work"]
        self.assertGreater(work["edited_bricks"], 0)
        # Masks, alphas and planes are read twice. Chunks of two pieces were unpacked twice: 3.5 times the bytes.
        self.assertLess(work["shard_bytes_read"], 2.2 * work["shard_bytes_written"])

    def test_a_damaged_shard_is_not_edited_but_baked_again(self):
        for name in shards(self.scene):
            if "/c_" in name:
                data = bytearray((self.scene / name).read_bytes())
                data[len(data) // 2] ^= 255
                (self.scene / name).write_bytes(bytes(data))
        report = json.loads(PROGRAM.succeed("edit", self.scene, "--paint=sphere:4,4,0,30", "--rgb=1,2,3", "--json"))
        self.assertEqual(report["run"]["work"]["edited_bricks"], 0)
        self.assertTrue(chose_device(report))
        self.expect_state(self.listed())

    def test_a_bake_of_the_source_applies_both_lists(self):
        first = {"type": "carve", "box": {"min_m": [-3, -3, -9], "max_m": [3, 3, 9]}}
        second = {"type": "fill", "sphere": {"position_m": [0, 0, 0], "radius_m": 2}, "rgb": [9, 9, 9]}
        PROGRAM.succeed("edit", self.scene, *shape_option(second), "-q")
        scene_file(self.source, [first])
        PROGRAM.succeed("bake", self.source, "-o", self.scene, "--voxel-size", VOXEL_M, *OPTIONS)
        self.assertEqual(self.listed(), [second])
        self.assertEqual(self.hash_of(self.scene), self.hash_from_nothing([first, second]))
        PROGRAM.succeed("verify", self.scene)

    def test_a_kill_leaves_the_scene_before_or_after_the_edit(self):
        batch = [{"type": "paint", "box": {"min_m": [-20, -20, -9], "max_m": [20, 20, 9]}, "rgb": [i, 7, 7]}
                 for i in range(30)]
        file = self.root / "kill.json"
        rng, edits = random.Random(11), []
        for attempt in range(KILLS):
            new = [dict(batch[0], rgb=[attempt, 1, 2]), random_edit(rng)]
            file.write_text(json.dumps({"edits": new}))
            command = [PROGRAM.executable, "edit", self.scene, "--from", file, "-q"]
            with subprocess.Popen(list(map(str, command)), stderr=subprocess.DEVNULL, start_new_session=True) as run:
                time.sleep(rng.uniform(0.02, 0.6))
                os.killpg(run.pid, signal.SIGKILL)
            found = self.listed()
            self.assertIn(found, (edits, edits + new))
            before_resume = self.hash_of(self.scene)
            allowed = [self.hash_from_nothing(edits), self.hash_from_nothing(edits + new)]
            self.assertIn(before_resume, allowed)
            if found == edits:
                PROGRAM.succeed("edit", self.scene, "--from", file, "-q")
            else:
                PROGRAM.succeed("bake", self.source, "-o", self.scene, "--voxel-size", VOXEL_M, *OPTIONS)
            edits += new
            self.assertEqual((self.listed(), self.hash_of(self.scene)), (edits, allowed[1]))

    def test_two_writers_lose_no_edit(self):
        for attempt in range(4):
            edits = self.listed()
            new = [{"type": "fill", "sphere": {"position_m": [x, 0, attempt], "radius_m": 2}, "rgb": [1, 2, 3]}
                   for x in (-5, 5)]
            command = lambda edit: [PROGRAM.executable, "edit", str(self.scene), *shape_option(edit), "-q"]
            runs = [subprocess.Popen(command(edit), stderr=subprocess.PIPE, text=True) for edit in new]
            errors = [run.communicate()[1] for run in runs]
            done = [edit for edit, run in zip(new, runs) if run.returncode == 0]
            for run, error in zip(runs, errors):
                if run.returncode != 0:
                    self.assertRegex(error, r"\Agigabake: .*(is being baked into|was changed by another process).*\n\Z")
            found = self.listed()
            self.assertTrue(done)
            self.assertEqual(found[:len(edits)], edits)
            self.assertCountEqual(found[len(edits):], done)
            self.assertEqual(self.hash_of(self.scene), self.hash_from_nothing(found))

    def test_a_geojson_polygon_and_degrees(self):
        place = {"lon_lat_height": [8, 47, 100]}
        source = scene_file(self.root / "placed.json", [], place)
        PROGRAM.succeed("bake", source, "-o", self.scene, "--voxel-size", VOXEL_M, *OPTIONS)
        ring = [[8 - 5e-5, 47 - 3e-5], [8 + 7e-5, 47 - 2e-5], [8 + 1e-5, 47 + 6e-5]]
        area = self.root / "area.geojson"
        area.write_text(json.dumps({"type": "Polygon", "coordinates": [[*ring, ring[0]]]}))
        PROGRAM.succeed("edit", self.scene, f"--carve=prism:{area},90,101.5", "-q")
        PROGRAM.succeed("edit", self.scene, "--fill=sphere:8.00001,47.00001,103,2", "--rgb=1,2,3", "--degrees", "-q")
        edits = self.listed()
        self.assertEqual(edits[1]["sphere"]["lon_lat_height"], [8.00001, 47.00001, 103])
        scene_file(source, edits, place)
        PROGRAM.succeed("bake", source, "-o", self.root / "placed", "--voxel-size", VOXEL_M, *OPTIONS)
        self.assertEqual(self.hash_of(self.scene), self.hash_of(self.root / "placed"))

    def test_a_fill_beyond_the_memory_limit_is_one_line_and_changes_nothing(self):
        out = self.root / "large"
        PROGRAM.succeed("bake", self.root / "ground.glb", "-o", out, "--voxel-size", VOXEL_M / 64, "--local",
                        "--cell-voxels", 4096, "-q")
        before = self.hash_of(out)
        result = PROGRAM.run("edit", out, "--fill=box:-12,-12,-12,12,12,12", "--rgb=1,2,3", "-q")
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertRegex(result.stderr, r"\Agigabake: .*filled voxels would take.*\n\Z")
        self.assertEqual(self.hash_of(out), before)

    def test_edits_of_sources_equal_those_of_a_scene_json(self):
        place = {"lon_lat_height": [8, 47, 100]}
        ring = [[8 - 5e-5, 47 - 3e-5], [8 + 7e-5, 47 - 2e-5], [8 + 1e-5, 47 + 6e-5]]
        area = self.root / "part.geojson"
        area.write_text(json.dumps({"type": "Polygon", "coordinates": [[*ring, ring[0]]]}))
        source = scene_file(self.root / "parts.json", [], place)
        PROGRAM.succeed("bake", source, "-o", self.scene, "--voxel-size", VOXEL_M, *OPTIONS)
        hashes = [self.hash_of(self.scene)]
        steps = ([f"--flatten={area},101.5"], [f"--raise={area},-2", "--source=ground.glb"],
                 ["--carve=sphere:8,47,101,3", "--degrees"], [f"--outside={area}"])
        for options in steps:
            PROGRAM.succeed("edit", self.scene, *options, "-q")
            hashes.append(self.hash_of(self.scene))
        self.assertEqual(len({tuple(h) for h in hashes}), len(hashes))
        edits = self.listed()
        self.assertEqual([edit["type"] for edit in edits], ["flatten", "raise", "carve", "outside"])
        self.assertEqual([edit.get("source") for edit in edits], [None, "ground.glb", None, None])
        of_source = [{k: v for k, v in e.items() if k != "source"} for e in edits if e["type"] != "carve"]
        entry = {"path": "ground.glb", "place": place, "edits": of_source}
        document = {"gigabake": 1, "sources": [entry], "edits": [edits[2]]}
        source.write_text(json.dumps(document))
        PROGRAM.succeed("bake", source, "-o", self.root / "parts", "--voxel-size", VOXEL_M, *OPTIONS)
        self.assertEqual(self.hash_of(self.root / "parts"), hashes[-1])
        source.write_text(json.dumps({**document, "sources": [{**entry, "edits": []}], "edits": []}))
        for before in reversed(hashes[:-1]):
            PROGRAM.succeed("edit", self.scene, "--undo", "-q")
            self.assertEqual(self.hash_of(self.scene), before)
        for options, text in ((["--source=other.glb", f"--outside={area}"], "'other.glb'"),
                              (["--source=ground.glb", "--carve=sphere:8,47,101,3"], "--source"),
                              ([f"--outside={area}", f"--inside={area}"], "exclude each other"),
                              ([f"--flatten={area}"], "--flatten: expected AREA.geojson,METRES"),
                              ([f"--raise={area},high"], "--raise")):
            with self.subTest(options=options):
                self.fail_with(2, *options, text=text)

    def test_sources_without_a_scene_json_are_edited_as_a_whole(self):
        ring = [[-4, -4], [5, -3], [1, 6]]
        out, file = self.root / "mesh", self.root / "mesh.json"
        PROGRAM.succeed("bake", self.root / "ground.glb", "-o", out, "--voxel-size", VOXEL_M, "--local", *OPTIONS)
        before = self.hash_of(out)
        file.write_text(json.dumps({"edits": [{"type": "outside", "rings_m": [ring]}]}))
        PROGRAM.succeed("edit", out, "--from", file, "-q")
        PROGRAM.succeed("verify", out)
        self.assertNotEqual(self.hash_of(out), before)
        PROGRAM.succeed("edit", out, "--undo", "-q")
        self.assertEqual(self.hash_of(out), before)
        file.write_text(json.dumps({"edits": [{"type": "outside", "rings_m": [ring], "source": "ground.glb"}]}))
        result = PROGRAM.run("edit", out, "--from", file)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn("only the sources of a scene .json have names", result.stderr)

    def test_bad_edits_are_one_line_and_change_nothing(self):
        broken = self.root / "broken.json"
        ball = {"position_m": [0, 0, 0], "radius_m": 1}
        broken.write_text(json.dumps({"edits": [{"type": "carve", "sphere": ball}, {"type": 3}]}))
        text = self.root / "text.json"
        text.write_text("{")
        for arguments, expected in (
                (["--carve=sphere:0,0,0"], "--carve: expected sphere:X,Y,Z,RADIUS"),
                (["--carve=ball:0,0,0,1"], "--carve: expected box:"),
                (["--carve=sphere:0,0,0,-1"], "radius_m"),
                (["--carve=box:0,0,0,1,0,1"], "along y"),
                (["--fill=sphere:0,0,0,1"], "--rgb: is missing"),
                (["--fill=sphere:0,0,0,1", "--rgb=1,2,300"], "--rgb: expected whole numbers"),
                (["--carve=sphere:0,0,0,1", "--rgb=1,2,3"], "--rgb: a carved voxel has no colour"),
                ([], "expected an edit"),
                (["--rgb=1,2,3"], "expected an edit"),
                (["--degrees"], "expected an edit"),
                (["--raise=area.geojson,3", "--rgb=1,2,3"], "--rgb: only --fill and --paint"),
                (["--raise=area.geojson,3", "--degrees"], "--degrees: only the shapes"),
                (["--list", "--undo"], "--list only prints"),
                (["--list", "--carve=sphere:0,0,0,1"], "--list only prints"),
                (["--fill=sphere:0,0,0,1", "--carve=sphere:0,0,0,1", "--rgb=1,2,3"], "exclude each other"),
                (["--carve=prism:nowhere.geojson,1,2"], "nowhere.geojson"),
                (["--carve=sphere:8,47,0,1", "--degrees"], "no place on the earth"),
                (["--carve=sphere:900,0,0,1"], "edits[0]: selects no voxel"),
                (["--undo"], "has no edits"),
                (["--from", broken], "broken.json: edits[1]"),
                (["--from", text], "text.json: not valid JSON")):
            with self.subTest(arguments=arguments):
                self.fail_with(2 if "nowhere" not in expected else 1, *arguments, text=expected)
        (self.scene / "source.json").unlink()
        self.fail_with(1, "--carve=sphere:0,0,0,1", text="source.json: does not exist")


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(Path(sys.argv[1]).resolve())
    ROUNDS = int(sys.argv[sys.argv.index("--rounds") + 1]) if "--rounds" in sys.argv else 6
    KILLS = max(4, ROUNDS // 2)
    harness.main(argv=sys.argv[:1], verbosity=2)
