"""Tests `gigabake sample`: it writes the files that it lists, they bake at their place, and voxel counts are right."""
import json
import shlex
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from harness import Gigabake, lod_hashes

SMALL = ("--size", 96, "--tiles", 2, "--ground-step", 2, "--texel", 1)


def sample(gigabake, folder, *options):
    return json.loads(gigabake.succeed("sample", folder, *SMALL, "--json", *options))


def files(folder):
    return {str(f.relative_to(folder)): f.read_bytes() for f in Path(folder).rglob("*") if f.is_file()}


def bytes_are_the_same_again(gigabake, work):
    sample(gigabake, work / "a")
    sample(gigabake, work / "b")
    assert files(work / "a") == files(work / "b")
    sample(gigabake, work / "a2", "--seed", 2)
    assert files(work / "a2") != files(work / "b")
    assert files(work / "a2").keys() == files(work / "b").keys()
    # Regression of 2026-11-25: another sample was overwritten without an error.
    refused = gigabake.run("sample", work / "a", *SMALL, "--seed", 2)
    assert refused.returncode == 1 and "holds a sample already" in refused.stderr, refused
    assert files(work / "a") == files(work / "b")


def suggested_commands_bake_what_was_written(gigabake, work):
    said = sample(gigabake, work / "c")
    tileset = json.loads((work / "c/tileset.json").read_text())
    assert said["tiles"] == len(tileset["root"]["children"]) == 4
    assert sum(len(f) for f in files(work / "c").values()) == said["bytes"]
    infos = []
    for name in ("bake", "bake_local"):
        program, *arguments = shlex.split(said[name].replace("SCENE", str(work / name)))
        assert program == "gigabake"
        gigabake.succeed(*arguments)
        infos.append(gigabake.info(work / name / "scene.xml"))
        assert infos[-1]["triangles"] == said["triangles"], "the finest tiles only"
    assert said["houses"] > 0 and said["trees"] > 0
    georeferenced, local = (info["lods"][0]["voxels"] for info in infos)
    assert abs(georeferenced - local) < 0.01 * local, (georeferenced, local)
    assert lod_hashes(infos[0]) != lod_hashes(infos[1]), "the earth is not flat"


def tiles_are_about_as_large_as_asked_for(gigabake, work):
    said = json.loads(gigabake.succeed("sample", work / "t", "--size", 96, "--tile-size", 30, "--ground-step", 4,
                                       "--texel", 2, "--json"))
    assert said["tiles"] == 3 * 3, said


def wrong_options_and_others_folders_are_refused(gigabake, work):
    for options in (("--size", 1), ("--tiles", 0), ("--tiles", 9999), ("--texel", 0), ("--ground-step", "nan"),
                    ("--tile-size", 0), ("--tile-size", 0.01), ("--tile-size", "nan"),
                    ("--tile-size", 48, "--tiles", 2),
                    ("--origin", "91,0,0"), ("--origin", "1,2")):
        result = gigabake.run("sample", work / "none", *options)
        assert result.returncode == 2, (options, result)
        assert len(result.stderr.strip().splitlines()) == 1, result.stderr
        assert not (work / "none").exists(), options
    mine = work / "mine"
    mine.mkdir()
    (mine / "thesis.tex").write_text("mine")
    result = gigabake.run("sample", mine)
    assert result.returncode == 1 and "not a sample" in result.stderr, result
    assert files(mine) == {"thesis.tex": b"mine"}


def fractal_terrain_has_the_peers_number_of_voxels(gigabake, work):
    """The terrain of 2 million triangles has 2.9 surface voxels per column, like the peers: 0.77 million at 512²."""
    fractal = Path(gigabake.executable).with_name("gigabake_fractal")
    if not fractal.exists():
        print("no gigabake_fractal next to the program: its counts are not checked")
        return
    terrain = work / "fractal.glb"
    Gigabake(fractal).succeed(terrain, "--quads", 1024)
    info = gigabake.bake(terrain, work / "fractal", 1 / 512, "--local")
    assert info["triangles"] == 2 * 1024 * 1024
    columns = info["lods"][0]["voxels"] / 512**2
    assert 2.7 < columns < 3.2, columns


def main():
    gigabake = Gigabake(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        for test in (bytes_are_the_same_again, suggested_commands_bake_what_was_written,
                     tiles_are_about_as_large_as_asked_for,
                     wrong_options_and_others_folders_are_refused, fractal_terrain_has_the_peers_number_of_voxels):
            print(test.__name__, flush=True)
            test(gigabake, Path(folder))


if __name__ == "__main__":
    main()
