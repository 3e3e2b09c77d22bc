"""The package gigabake of this source folder. Tests that import this module are skipped without its dependencies."""
import os
import sys
from pathlib import Path

FOLDER = Path(__file__).resolve().parents[2] / "python"
sys.path.insert(0, str(FOLDER))

try:
    import h5py
    import lz4.block
    import numpy
except ImportError as error:
    print(f"skipped: {error} (python3-h5py, python3-lz4)")
    sys.exit(77)
import gigabake


def environment(program):
    """Returns the environment of an installed package and program."""
    return {**os.environ, "PYTHONPATH": str(FOLDER), "GIGABAKE": str(Path(program).resolve()),
            "PYTHONDONTWRITEBYTECODE": "1", "MPLBACKEND": "Agg"}
