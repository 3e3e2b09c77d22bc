"""Random choices of the generator, and the results that it expects for a file."""
import random
from dataclasses import dataclass, field

VOXEL = 0.5
BLOCK = 20  # voxels along x for each file of a bake


class Odd(random.Random):
    """A random generator with the choices that writers of files make.

    A plain file has only what assimp reads too: beyond() is false for it.
    """

    is_plain = False

    def beyond(self, probability):
        return self.maybe(probability) and not self.is_plain

    def maybe(self, probability=0.5):
        return self.random() < probability

    def number(self, value, exact=False):
        """Returns a spelling of a number. exact: with all digits of a double."""
        value = float(value)
        if exact or value != round(value, 6):
            return self.choice([repr(value), f"{value:.17g}", f"{value:.16e}", f"{value:.17E}"])
        spelt = self.choice([f"{value:.6f}", f"{value:g}", repr(value), f"{value:.9e}", f"{value:.8E}"])
        if float(spelt) != value:
            return repr(value)
        if "e" not in spelt.lower() and self.beyond(0.1):
            spelt = spelt.replace("0.", ".", 1) if spelt.startswith(("0.", "-0.")) and len(spelt) > 3 else spelt
        if value > 0 and self.beyond(0.05):
            spelt = "+" + spelt
        return spelt

    def colour(self):
        return tuple(self.choice((0, 13, 40, 77, 120, 200, 255, self.randrange(256))) for _ in range(3))

    def colours(self, count):
        """Returns colours that differ strongly."""
        out = []
        while len(out) < count:
            one = tuple(self.randrange(256) for _ in range(3))
            if all(max(abs(a - b) for a, b in zip(one, other)) > 40 for other in out):
                out.append(one)
        return out

    def word(self):
        return "".join(self.choice("abcdefghijkmnopqrstuvwxyz") for _ in range(self.randint(3, 8)))

    def file_name(self, suffix):
        """Returns a name with characters that are special in URIs or in lines of words."""
        middle = self.choice(["", "", "", " ", "-", ".", "_", "é", "日本", "%20", "+", "&", "'", "(1)", "~", "@",
                              ",", ";", "=", "!", "$", "#1"])
        return self.word() + middle + self.word() + suffix


@dataclass
class Case:
    """A source and its expected result."""
    kind: str
    source: str  # path of the file below the folder of the case
    voxels: dict = field(default_factory=dict)  # (i, j, k) -> (colour or None, alpha)
    triangles: int = None
    skipped_points: int = 0
    skipped_lines: int = 0
    losses: list = field(default_factory=list)  # prefix of the reason of each loss
    warnings: list = field(default_factory=list)  # (text, count, files) of each expected warning
    place: tuple = (0, 0, 0)  # offset in the file's coordinates, z up, metres
    colour_tolerance: int = 1
    tolerance: float = 0.4  # metres, for heights: more than half a voxel
    refusal: str = None  # words of the reason, if the program must refuse the file
    outside: dict = field(default_factory=dict)  # counts and bounds for other programs
    notes: list = field(default_factory=list)  # choices of the generator
    slot: int = None  # position of the voxels along x, if not in the order of the sources
    folder: object = None
    index: int = None
