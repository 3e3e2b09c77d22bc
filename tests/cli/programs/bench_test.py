#!/usr/bin/env python3
"""The benchmarks print times and the error of the same run; they touch no scene.

Usage: bench_test.py GIGABAKE SOURCE_DIR
"""
import json
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from harness import Gigabake


def kernels_are_timed_with_their_hash(gigabake, work):
    options = (work / "sample/tileset.json", "--voxel-size", 0.25, "--cell-voxels", 256, "--backend", "cpu")
    bench = json.loads(gigabake.succeed("bench", "kernels", *options, "--repeats", 1, "--json"))
    backend = bench["backends"][0]
    assert backend["backend"] == "cpu" and len(backend["content_hash"]) == 32, backend
    assert 0 < sum(backend["seconds"].values()) <= backend["total_s"] * 1.01, backend
    assert bench["output_bytes"] > 6 * bench["voxels"] and not bench["differ"], bench
    assert "voxels/s" in gigabake.succeed("bench", "kernels", *options, "--repeats", 1)


def bakes_are_timed_alone_and_overlapped(gigabake, work):
    options = (work / "sample/tileset.json", "-o", work / "bench", "--voxel-size", 0.25, "--cell-voxels", 128,
               "--cells", 5, "--backend", "cpu")
    bench = json.loads(gigabake.succeed("bench", "bake", *options, "--json"))
    assert bench["cells"] == 5 and not bench["differ"], bench
    assert bench["alone_s"][bench["slowest_stage"]] == max(bench["alone_s"].values()), bench


def chunks_are_packed_again(gigabake, work):
    gigabake.bake(work / "sample/tileset.json", work / "packed", 0.5, "--cell-voxels", 128)
    options = ("bench", "pack", work / "packed/shards", "--repeats", 1)
    bench = json.loads(gigabake.succeed(*options, "--json"))
    assert not bench["differ"] and "rgb" in bench["columns"], bench
    assert 0 < bench["all"]["bytes"] <= 1.05 * bench["all"]["libdeflate_bytes"], bench
    assert "all results are equal" in gigabake.succeed(*options)
    (work / "nothing").mkdir()
    result = gigabake.run("bench", "pack", work / "nothing")
    assert result.returncode != 0 and "holds no shards" in result.stderr, result


def schedules_are_near_the_lower_bound(gigabake, _):
    size = ("bench", "schedule", "--cells", 20000, "--workers", 50, "--seed", 3)
    bench = json.loads(gigabake.succeed(*size, "--json"))
    assert bench["done"] == bench["dispatches"] == 20000 and not bench["differ"], bench
    assert 1 <= bench["ratio"] <= 1.05, bench
    assert "dispatches/s" in gigabake.succeed(*size)


def schedules_survive_failures(gigabake, _):
    bench = json.loads(gigabake.succeed("bench", "schedule", "--cells", 20000, "--workers", 50, "--seed", 3, "--deaths",
                                        20, "--silences", 3, "--failing-cells", 30, "--killing-cells", 10, "--json"))
    assert bench["done"] + bench["failed"] == 20000 and bench["abandoned"] == 0 and not bench["differ"], bench
    assert 35 <= bench["failed"] <= 40, bench
    assert bench["lost_workers"] >= 1 and bench["retries"] >= 2 * bench["failed"], bench


def first_hits_are_timed_and_compared(gigabake, work):
    gigabake.bake(work / "sample/tileset.json", work / "rays", 0.5, "--cell-voxels", 64)
    options = ("bench", "render", work / "rays/scene.xml", "--size", "64x40", "--repeats", 1, "--backend", "cpu")
    bench = json.loads(gigabake.succeed(*options, "--json"))["first_hit"]
    assert len(bench["views"]) == 9 and bench["voxels"] > 1000, bench
    for view in bench["views"]:
        assert view["differ"] == view["wrong"] == 0 and view["reference_rays"] > 2000, view
        assert 0 < view["backends"][0]["best_s"] <= view["backends"][0]["median_s"], view
    assert sum(view["hits"] for view in bench["views"]) > 1000, bench
    assert "close, perspective" in gigabake.succeed(*options, "--lod", 1, "--reference-rays", 1)
    for size in ("64", "0x40", "64x40x3"):
        result = gigabake.run("bench", "render", work / "rays/scene.xml", "--size", size)
        assert result.returncode == 2 and "--size" in result.stderr, result


def edits_are_timed_and_undone(gigabake, work):
    scene = work / "edited"
    gigabake.bake(work / "sample/tileset.json", scene, 0.5, "--cell-voxels", 64)
    before = (scene / "scene.xml").read_bytes()
    options = ("bench", "edit", scene, "--size", "64x40", "--brush", 8, "--distance", 60, "--repeats", 1,
               "--backend", "cpu")
    bench = json.loads(gigabake.succeed(*options, "--json"))
    assert [edit["type"] for edit in bench["edits"]] == ["paint", "carve", "fill"], bench
    for edit in bench["edits"]:
        assert 0 < edit["disk_s"] < edit["image_s"] <= edit["rest_s"] and edit["undo_s"] > 0, edit
        # The whole view has more than 1,500 bricks and lists of children.
        assert 0 < edit["uploads"] < 200 and edit["preview_s"] > 0, edit
    assert bench["same_as_rendered"] and bench["is_restored"], bench
    assert (scene / "scene.xml").read_bytes() == before
    assert "equal bytes" in gigabake.succeed(*options)
    result = gigabake.run("bench", "edit", scene, "--brush", 0)
    assert result.returncode == 2 and "--brush" in result.stderr, result


# Regressions of 2026-11-28: images of leaves depended on bricks that were resident before, and after an edit viewers
# showed the finer voxels of expanded leaves.
def images_of_leaves_are_exact_in_a_viewer(gigabake, work):
    gigabake.succeed("sample", work / "other", "--size", 64, "--seed", 9)
    sources = [{"path": "sample/tileset.json", "voxel_size_m": 2}, {"path": "other/tileset.json"}]
    (work / "two.json").write_text(json.dumps({"gigabake": 1, "sources": sources}))
    scene = work / "two"
    gigabake.bake(work / "two.json", scene, 0.25, "--cell-voxels", 128)
    gigabake.succeed("bench", "render", scene, "--what", "live", "--size", "320x240", "--backend", "cpu")
    gigabake.succeed("bench", "edit", scene, "--size", "200x150", "--brush", 20, "--distance", 90, "--repeats", 1,
                     "--backend", "cpu")


# Regression of 2026-11-25: exit code 0 with 0 voxels, 0 chunks, 0 compared rays or images without a surface.
def what_measured_nothing_fails(gigabake, work):
    (work / "clear.mtl").write_text("newmtl clear\nd 0\n")
    clear = work / "clear.obj"
    clear.write_text("mtllib clear.mtl\nusemtl clear\nv 0 0 0\nv 60 0 0\nv 0 60 0\nf 1 2 3\n")
    voxels = ("--local", "--voxel-size", 1, "--cell-voxels", 64, "--backend", "cpu")
    gigabake.bake(work / "sample/tileset.json", work / "lost", 1, "--cell-voxels", 64)
    scene = work / "lost/scene.xml"
    for code, expected, *arguments in (
            (1, "nothing was measured", "kernels", clear, *voxels),
            (1, "nothing was measured", "bake", clear, "-o", work / "clear", *voxels),
            (1, "nothing was measured", "pack", work / "lost/shards", "--most-bytes", 0),
            (2, "--reference-rays", "render", scene, "--reference-rays", 0)):
        result = gigabake.run("bench", *arguments)
        assert result.returncode == code and expected in result.stderr, result
        assert len(result.stderr.strip().splitlines()) == 1, result
    for shard in (work / "lost/shards").iterdir():
        shard.unlink()
    for part in ("frames", "flight", "live"):
        result = gigabake.run("bench", "render", scene, "--what", part, "--size", "16x12", "--repeats", 1, "--flight",
                              2, "--backend", "cpu")
        assert result.returncode == 1 and "nothing was measured" in result.stderr, result


def a_scene_is_not_overwritten(gigabake, work):
    scene = work / "scene"
    gigabake.bake(work / "sample/tileset.json", scene, 1)
    before = sorted(scene.rglob("*"))
    result = gigabake.run("bench", "bake", work / "sample/tileset.json", "-o", scene, "--voxel-size", 1)
    assert result.returncode == 1 and "holds a scene" in result.stderr, result
    assert sorted(scene.rglob("*")) == before


def main():
    gigabake = Gigabake(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        gigabake.succeed("sample", work / "sample", "--size", 96)
        for test in (kernels_are_timed_with_their_hash, bakes_are_timed_alone_and_overlapped, chunks_are_packed_again,
                     schedules_are_near_the_lower_bound, schedules_survive_failures,
                     first_hits_are_timed_and_compared, edits_are_timed_and_undone,
                     images_of_leaves_are_exact_in_a_viewer, what_measured_nothing_fails,
                     a_scene_is_not_overwritten):
            print(test.__name__, flush=True)
            test(gigabake, work)


if __name__ == "__main__":
    main()
