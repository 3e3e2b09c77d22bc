"""Runs the program gigabake and parses its JSON. docs/schemas describes the results."""
from __future__ import annotations

import io
import json
import os
import shutil
import subprocess
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy
from numpy.typing import ArrayLike, NDArray

from .errors import GigabakeError, IncompleteWarning

Option = str | int | float | Path
COMPLETE, INCOMPLETE = 0, 3


def program_path(program: Path | str | None = None) -> str:
    """Returns the program: the argument, or the environment variable GIGABAKE, or gigabake in the PATH."""
    name = str(program or os.environ.get("GIGABAKE") or "gigabake")
    found = shutil.which(name)
    if found is None:
        raise GigabakeError(name, "", "is not an executable program",
                            "install gigabake, or name it by program=… or by the environment variable GIGABAKE")
    return found


def run(command: str, arguments: Sequence[Option], subject: Path | str, stdin: bytes = b"",
        ranks: int | None = None, program: Path | str | None = None) -> bytes:
    """Runs a command and returns its standard output.

    Raises GigabakeError if it fails. Warns with IncompleteWarning if cells or inputs are missing (exit status 3).
    """
    words = [program_path(program), command, *map(str, arguments)]
    if ranks is not None:
        words = ["mpirun", "-n", str(ranks), *words]
    try:
        done = subprocess.run(words, input=stdin, capture_output=True, check=False)
    except OSError as error:
        raise GigabakeError(words[0], "", f"cannot be started: {error.strerror}", "check that it is installed") from error
    lines = done.stderr.decode("utf-8", "replace").strip().splitlines()
    if done.returncode == INCOMPLETE:
        warnings.warn(f"gigabake {command} {subject}: " + " ".join(lines[-3:]), IncompleteWarning, stacklevel=3)
    elif done.returncode != COMPLETE:
        cause = lines[-1].removeprefix("gigabake: ") if lines else "no message"
        raise GigabakeError(subject, f"gigabake {command}", f"exit status {done.returncode}: {cause}",
                            f"gigabake {command} --help explains the options")
    return done.stdout


def json_of(command: str, output: bytes) -> Any:
    """Returns the JSON that a command printed."""
    try:
        return json.loads(output)
    except ValueError as error:
        raise GigabakeError("gigabake", command, f"printed no JSON: {error}", "use a program of this version") from error


def plan(source: Path | str, voxel_size_m: float, *options: Option, program: Path | str | None = None) -> dict[str, Any]:
    """Predicts voxels, bytes and seconds of a bake (docs/schemas/plan-1.json). The options of `gigabake plan` follow."""
    arguments = [source, "--voxel-size", voxel_size_m, "--json", *options]
    result: dict[str, Any] = json_of("plan", run("plan", arguments, source, program=program))
    return result


def bake(source: Path | str, out: Path | str, voxel_size_m: float, *options: Option, ranks: int | None = None,
         program: Path | str | None = None) -> dict[str, Any]:
    """Bakes a source into a folder and returns the report (docs/schemas/bake-1.json).

    The options of `gigabake bake` follow. The bake runs under mpirun if `ranks` is given.
    """
    arguments = [source, "-o", out, "--voxel-size", voxel_size_m, "--json", *options]
    result: dict[str, Any] = json_of("bake", run("bake", arguments, source, ranks=ranks, program=program))
    return result


def table_of(rays: ArrayLike | None, heights: ArrayLike | None, sights: ArrayLike | None) -> tuple[str, bytes]:
    """Returns the option and the NumPy file of the one table that is given."""
    tables = {"--rays": rays, "--heights": heights, "--sights": sights}
    given = [(name, table) for name, table in tables.items() if table is not None]
    if len(given) != 1:
        raise ValueError("expected one of rays, heights and sights")
    name, table = given[0]
    file = io.BytesIO()
    numpy.save(file, numpy.ascontiguousarray(numpy.atleast_2d(numpy.asarray(table, "<f8"))))
    return name, file.getvalue()


def query(scene: Path | str, *options: Option, rays: ArrayLike | None = None, heights: ArrayLike | None = None,
          sights: ArrayLike | None = None, program: Path | str | None = None) -> list[dict[str, Any]]:
    """Queries what rays hit, how high the surface is, or whether points see each other.

    Returns an answer per row of the table (docs/schemas/query-1.json). The table has the columns of docs/query.md. The
    options of `gigabake query` follow the scene.
    """
    name, table = table_of(rays, heights, sights)
    output = run("query", [scene, name, "-", "--format", "json", *options], scene, table, program=program)
    result: list[dict[str, Any]] = json_of("query", output)
    return result


def query_array(scene: Path | str, *options: Option, rays: ArrayLike | None = None, heights: ArrayLike | None = None,
                sights: ArrayLike | None = None, program: Path | str | None = None) -> NDArray[Any]:
    """Returns the answers of query() as records of numpy, which is faster for long tables (docs/query.md)."""
    name, table = table_of(rays, heights, sights)
    output = run("query", [scene, name, "-", "--format", "npy", *options], scene, table, program=program)
    answers: NDArray[Any] = numpy.load(io.BytesIO(output))
    return answers


def profile(scene: Path | str, line: Path | str, step_m: float, *options: Option,
            program: Path | str | None = None) -> list[dict[str, Any]]:
    """Queries heights along the line of a GeoJSON file, a step apart (docs/schemas/query-1.json).

    The options of `gigabake query` follow.
    """
    arguments = [scene, "--profile", line, f"--step={float(step_m)!r}", "--format", "json", *options]
    result: list[dict[str, Any]] = json_of("query", run("query", arguments, scene, program=program))
    return result


def volume(scene: Path | str, area: Path | str, *options: Option, above_m: float | None = None,
           against: Path | str | None = None, program: Path | str | None = None) -> dict[str, Any]:
    """Measures cut and fill inside the polygons of a GeoJSON file (docs/schemas/volume-1.json).

    The reference is a height above the WGS84 ellipsoid or another scene. The options of `gigabake query` follow.
    """
    reference: list[Option]
    if above_m is not None and against is None:
        reference = [f"--above={float(above_m)!r}"]
    elif against is not None and above_m is None:
        reference = ["--against", against]
    else:
        raise ValueError("expected one of above_m and against")
    arguments = [scene, "--volume", area, *reference, "--format", "json", *options]
    result: dict[str, Any] = json_of("query", run("query", arguments, scene, program=program))
    return result
