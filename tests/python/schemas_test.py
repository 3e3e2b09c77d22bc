#!/usr/bin/env python3
"""Each JSON output of the program has the form that docs/schemas publishes, without members that a schema lacks.

Usage: schemas_test.py GIGABAKE SOURCE_DIR
"""
import copy
import json
import os
import re
import shutil
import sys
import warnings
from pathlib import Path
from unittest import mock

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "cli/support"))
from package_imports import gigabake

try:
    import jsonschema
except ImportError as error:
    print(f"skipped: {error} (python3-jsonschema)")
    sys.exit(77)

import harness

SCHEMAS = Path(sys.argv[2]) / "docs/schemas"
QUESTIONS = {"rays": [[0, 0, 900, 0, 0, -1], [0, 0, 900, 0, 0, 1]], "heights": [[0, 0], [1e6, 0]],
             "sights": [[0, 0, 9, 5, 5, -9], [0, 0, 9, 5, 5, 9]]}


def closed(schema):
    """Returns the schema with every object refusing members that it does not list."""
    if isinstance(schema, dict):
        schema = {key: closed(value) for key, value in schema.items()}
        if "properties" in schema and isinstance(schema.get("required"), list):
            schema.setdefault("additionalProperties", False)
    elif isinstance(schema, list):
        schema = [closed(item) for item in schema]
    return schema


def validator(name):
    schema = json.loads((SCHEMAS / f"{name}.json").read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(closed(schema))


class Schemas(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        options = {"program": PROGRAM.executable}
        root, outputs = cls.root, {}
        outputs["sample-1"] = [cls.printed("sample", root / "source", "--size", 64, "--tiles", 2)]
        source, scene = root / "source/tileset.json", root / "scene"
        report = root / "report.json"
        baked = gigabake.bake(source, scene, 1, "--cell-voxels", 32, "--report", report, **options)
        again = gigabake.bake(source, scene, 1, "--cell-voxels", 32, **options)
        outputs["bake-1"] = [baked, json.loads(report.read_text(encoding="utf-8")), again]
        outputs["plan-1"] = [gigabake.plan(source, 2, **options), gigabake.plan(source, 2, "--no-measure", **options),
                             gigabake.plan(source, 1, "--cell-voxels", 32, "-o", scene, "--no-measure", **options)]
        outputs["query-1"] = [gigabake.query(scene, **{kind: table}, **options) for kind, table in QUESTIONS.items()]
        (root / "places.csv").write_text("id,x,y\nhere,0,0\n", encoding="utf-8")
        outputs["query-1"].append(cls.printed("query", scene, "--heights", root / "places.csv", "--format", "json"))
        outputs["query-1"].append(cls.printed("query", scene, "--grid=-2,-2,2,2", "--step", 2, "--format", "json"))
        outputs["volume-1"] = cls.volumes(scene, root, options)
        outputs["query-1"].append(cls.profile(scene, root, options))
        with mock.patch.dict(os.environ, harness.MPI_ENVIRONMENT):
            outputs["bake-1"].append(gigabake.bake(source, root / "ranks", 1, "--cell-voxels", 32, ranks=2, **options))
        gigabake.bake(source, root / "other", 1, "--cell-voxels", 32, "--surface", "conservative", **options)
        outputs["info-1"], outputs["verify-1"] = ([cls.printed(name, scene)] for name in ("info", "verify"))
        cls.lost = cls.incomplete(source, options, outputs)
        outputs["status-1"] = [cls.printed("status", scene)]
        outputs["diff-1"] = [cls.printed("diff", scene, scene), cls.printed("diff", scene, root / "other")]
        cls.outputs = outputs

    @classmethod
    def profile(cls, scene, root, options):
        """Returns the profile of a line of some ten metres in the middle of the scene."""
        lat, lon = gigabake.open(scene).origin[:2]
        line = root / "line.geojson"
        text = json.dumps({"type": "LineString", "coordinates": [[lon, lat], [lon + 1e-4, lat + 1e-4]]})
        line.write_text(text, encoding="utf-8")
        return gigabake.profile(scene, line, 2, **options)

    @classmethod
    def volumes(cls, scene, root, options):
        """Returns the volumes of a square of some ten metres in the middle of the scene."""
        lat, lon = gigabake.open(scene).origin[:2]
        ring = [[lon + x, lat + y] for x, y in ((0, 0), (1e-4, 0), (1e-4, 1e-4), (0, 1e-4), (0, 0))]
        area = root / "area.geojson"
        area.write_text(json.dumps({"type": "Polygon", "coordinates": [ring]}), encoding="utf-8")
        return [gigabake.volume(scene, area, above_m=600, **options),
                gigabake.volume(scene, area, against=scene, **options)]

    @classmethod
    def incomplete(cls, source, options, outputs):
        """Plans and bakes a copy of the source that lost a tile. Returns the warnings, and the lost file."""
        folder = cls.root / "lost"
        shutil.copytree(source.parent, folder)
        tile = next(path for path in sorted(folder.rglob("tile_*.glb")) if "local" not in path.parts)
        tile.unlink()
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            outputs["plan-1"].append(gigabake.plan(folder / source.name, 1, "--no-measure", **options))
            outputs["bake-1"].append(gigabake.bake(folder / source.name, cls.root / "part", 1, **options))
            outputs["query-1"].append(gigabake.query(cls.root / "part", heights=[[0, 0]], **options))
            gigabake.open(cls.root / "part").level(0).region()
        outputs["info-1"].append(cls.printed("info", cls.root / "part"))
        outputs["verify-1"].append(cls.printed("verify", cls.root / "part"))
        return caught, tile.name

    @classmethod
    def printed(cls, command, *arguments):
        as_json = [] if command == "query" else ["--json"]
        result = PROGRAM.run(command, *arguments, *as_json)
        assert result.returncode in (0, 1, 3), result
        return json.loads(result.stdout)

    def test_each_schema_is_valid_and_listed(self):
        listed = re.findall(r"^\| \[([\w-]+)\.json\]", (SCHEMAS / "README.md").read_text(encoding="utf-8"), re.M)
        names = sorted(path.stem for path in SCHEMAS.glob("*.json"))
        self.assertEqual(sorted(listed), names)
        self.assertEqual(sorted(self.outputs), names)
        for name in names:
            schema = json.loads((SCHEMAS / f"{name}.json").read_text(encoding="utf-8"))
            self.assertRegex(name, r"^[a-z]+-\d+$")
            self.assertEqual(schema["$id"], f"gigabake:schemas/{name}")

    def test_outputs_have_the_published_form(self):
        for name, outputs in self.outputs.items():
            for number, output in enumerate(outputs):
                with self.subTest(schema=name, output=number):
                    self.assertEqual([f"{error.json_path}: {error.message}"
                                      for error in validator(name).iter_errors(output)], [])

    def test_outputs_cover_different_forms(self):
        plans = self.outputs["plan-1"]
        self.assertEqual([plan["sizes"][1]["seconds"] is None for plan in plans], [False, True, True, True])
        self.assertEqual(plans[2]["remaining"]["cells"], 0)
        self.assertEqual(self.outputs["bake-1"][2]["cells_taken_over"], self.outputs["bake-1"][2]["cells_planned"])
        self.assertEqual([report["ranks"] for report in self.outputs["bake-1"]], [1, 1, 1, 2, 1])
        outcomes = {answer["outcome"] for answers in self.outputs["query-1"] for answer in answers}
        self.assertLessEqual({"hit", "blocked", "visible", "outside the scene"}, outcomes)
        self.assertEqual([diff["same"] for diff in self.outputs["diff-1"]], [True, False])
        self.assertGreater(len(self.outputs["diff-1"][1]["cells"]), 0)

    def test_incomplete_results_warn(self):
        caught, tile = self.lost
        self.assertEqual([warning.category for warning in caught], 4 * [gigabake.IncompleteWarning])
        self.assertEqual({warning.filename for warning in caught}, {__file__})
        self.assertIn(tile, str(caught[3].message))
        for name in ("plan-1", "bake-1", "info-1"):
            self.assertIn(tile, str(self.outputs[name][-1]["losses"]))

    def test_a_missing_a_wrong_and_an_additional_member_are_noticed(self):
        for name, outputs in self.outputs.items():
            check, output = validator(name), outputs[0]
            form = check.schema.get("items", check.schema)
            faults = [("additional", 0)]
            faults += [(key, None) for key in form["required"]]  # None: without the member
            faults += [(key, {"no": "such type"}) for key, part in form["properties"].items()
                       if "properties" in part or part.get("type") != "object"]
            for key, value in faults:
                changed = copy.deepcopy(output)
                item = changed[0] if isinstance(changed, list) else changed
                item[key] = value
                if value is None:
                    del item[key]
                with self.subTest(schema=name, key=key, value=value):
                    self.assertFalse(check.is_valid(changed))


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1], verbosity=2)
