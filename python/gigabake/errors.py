"""The exception and the warning of the package."""
from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


class GigabakeError(Exception):
    """An error with the file, the key in it, the cause and the remedy.

    The key is an attribute, a dataset or an option; it is empty if the error is about the whole file.
    """

    def __init__(self, file: Path | str, key: str, cause: str, remedy: str) -> None:
        super().__init__(file, key, cause, remedy)
        self.file = Path(file)
        self.key = key
        self.cause = cause
        self.remedy = remedy

    def __str__(self) -> str:
        place = f"{self.file}: {self.key}" if self.key else str(self.file)
        return f"{place}: {self.cause}; {self.remedy}"


class IncompleteWarning(UserWarning):
    """A warning that a bake lost cells or inputs, so that a result lacks their voxels."""


BAKE_AGAIN = "bake again, or copy the scene again; gigabake verify lists all faults"
NEWER_PROGRAM = "install a newer gigabake package"

# h5py raises any of these for damaged files.
DAMAGES = (OSError, KeyError, ValueError, RuntimeError, TypeError, IndexError, OverflowError)


@contextmanager
def damage_of(file: Path, key: str) -> Iterator[None]:
    """Turns the errors of h5py and numpy for damaged content into a GigabakeError."""
    try:
        yield
    except DAMAGES as error:
        raise GigabakeError(file, key, f"cannot be read: {error}", BAKE_AGAIN) from error
