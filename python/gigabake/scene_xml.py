"""Reader of scene.xml and its pages (docs/format.md, "scene.xml"): which shards a scene has, and where they lie."""
from __future__ import annotations

import json
import xml.etree.ElementTree as xml
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

from .errors import BAKE_AGAIN, NEWER_PROGRAM, GigabakeError

OLDEST_SCENE_VERSION, NEWEST_SCENE_VERSION = 1, 7
BRICK_EDGE = 8
MAX_LODS = 62
MAX_PAGES_KEPT = 64  # of some 512 shards each, about 1 KB per shard

Index = tuple[int, int, int]


@dataclass(frozen=True)
class Box:
    """A half-open box of the lattice, in voxels of level 0."""

    low: Index
    end: Index

    def overlaps(self, other: Box) -> bool:
        """Returns whether the boxes have a voxel in common."""
        return all(self.low[a] < other.end[a] and other.low[a] < self.end[a] for a in range(3))


def cube(low: Index, edge: int) -> Box:
    """Returns the cube of this edge."""
    return Box(low, (low[0] + edge, low[1] + edge, low[2] + edge))


@dataclass(frozen=True)
class ShardEntry:
    """A cell or an overview, as scene.xml or a page lists it."""

    name: str
    file: Path
    window: Box
    lods: int
    first_lod: int
    copied_lods: int
    bytes: int
    triangles: int
    voxels: tuple[int, ...]
    fingerprint: str
    content_hash: tuple[str, ...]

    def owns(self, lod: int) -> bool:
        """Returns whether the shard has this level of the lattice, and does not duplicate it from other shards."""
        return self.first_lod + self.copied_lods <= lod < self.first_lod + self.lods


@dataclass(frozen=True)
class PageEntry:
    """A reference to a page, with the sums over the shards below it."""

    file: Path
    block: Box
    window: Box | None
    cells: int
    voxels: tuple[int, ...]


@dataclass
class Listing:
    """The content of scene.xml or of one page."""

    shards: list[ShardEntry]
    pages: list[PageEntry]
    losses: list[tuple[str, str]]


class Element:
    """The attributes of an XML element. Errors name the file and the attribute."""

    def __init__(self, file: Path, element: xml.Element) -> None:
        self.file = file
        self.element = element
        self.name = element.get("Name", "")

    def fail(self, key: str, cause: str, remedy: str = BAKE_AGAIN) -> GigabakeError:
        """Returns the error of an attribute."""
        return GigabakeError(self.file, " ".join(filter(None, (self.element.tag, self.name, key))), cause, remedy)

    def has(self, key: str) -> bool:
        """Returns whether the attribute exists."""
        return key in self.element.attrib

    def text(self, key: str) -> str:
        """Returns the text of an attribute."""
        if key not in self.element.attrib:
            raise self.fail(key, "is missing")
        return self.element.attrib[key]

    def integers(self, key: str, count: int | None = None) -> tuple[int, ...]:
        """Returns the integers of an attribute."""
        text = self.text(key)
        try:
            values = tuple(int(word) for word in text.split())
        except ValueError:
            raise self.fail(key, f"expected integers, not '{text[:80]}'") from None
        if count is not None and len(values) != count:
            raise self.fail(key, f"expected {count} integers, not '{text[:80]}'")
        return values

    def integer(self, key: str, default: int | None = None) -> int:
        """Returns the integer of an attribute, or the default if the attribute is absent."""
        return default if default is not None and not self.has(key) else self.integers(key, 1)[0]

    def index(self, key: str) -> Index:
        """Returns a position on the lattice."""
        x, y, z = self.integers(key, 3)
        return x, y, z

    def numbers(self, key: str, count: int) -> tuple[float, ...]:
        """Returns the numbers of an attribute."""
        text = self.text(key)
        try:
            values = tuple(float(word) for word in text.split())
        except ValueError:
            values = ()
        if len(values) != count:
            raise self.fail(key, f"expected {count} numbers, not '{text[:80]}'")
        return values

    def box(self, low: str, end: str) -> Box | None:
        """Returns the box of two attributes, or None if they are absent."""
        return Box(self.index(low), self.index(end)) if self.has(low) and self.has(end) else None


def root_of(file: Path) -> Element:
    """Reads an XML file and returns its outermost group."""
    try:
        root = xml.parse(file).getroot()
    except FileNotFoundError:
        raise GigabakeError(file, "", "does not exist", "expected the folder of a bake or its scene.xml") from None
    except OSError as error:
        raise GigabakeError(file, "", f"cannot be read: {error.strerror}", "check the file and its folder") from error
    except xml.ParseError as error:
        raise GigabakeError(file, "", f"is not valid XML: {error}", BAKE_AGAIN) from error
    if root.tag != "OctTreeGroup":
        raise GigabakeError(file, root.tag, "expected the element OctTreeGroup", "name the scene.xml of a bake")
    return Element(file, root)


def inside(element: Element, key: str, folder: Path) -> Path:
    """Returns the path of a file that an attribute names. The file must lie in the scene's folder."""
    name = element.text(key)
    path = PurePosixPath(name)
    if not name or path.is_absolute() or ".." in path.parts or "\0" in name:
        raise element.fail(key, f"expected a file below the scene's folder, not '{name[:80]}'")
    return folder / path


def shard_entry(element: Element, folder: Path) -> ShardEntry:
    """Returns the shard that a PagedOctTree describes."""
    edge, lods = element.integer("CellVoxels"), element.integer("Lods")
    first_lod, copied = element.integer("FirstLod", 0), element.integer("CopiedLods", 0)
    if not (0 < lods <= MAX_LODS and 0 <= first_lod <= MAX_LODS and 0 <= copied <= lods
            and edge == BRICK_EDGE << (lods + first_lod - 1)):
        raise element.fail("CellVoxels", "does not agree with Lods, FirstLod and CopiedLods")
    voxels = element.integers("Voxels", lods)
    hashes = tuple(element.text("ContentHash").split())
    if min(voxels) < 0 or len(hashes) != lods:
        raise element.fail("Voxels", "expected a count and a content hash per level")
    return ShardEntry(element.text("Name"), inside(element, "TreeFile", folder),
                      cube(element.index("LatticeMin"), edge), lods, first_lod, copied, element.integer("Bytes"),
                      element.integer("Triangles"), voxels, element.text("Fingerprint"), hashes)


def page_entry(element: Element, folder: Path) -> PageEntry:
    """Returns the reference to a page."""
    return PageEntry(inside(element, "GroupFile", folder),
                     cube(element.index("BlockMin"), element.integer("BlockVoxels")),
                     element.box("LatticeMin", "LatticeEnd"), element.integer("Cells"), element.integers("Voxels"))


def listing_of(group: Element, folder: Path) -> Listing:
    """Returns what a group and the groups in it list."""
    found = Listing([], [], [])
    for child in group.element:
        element = Element(group.file, child)
        if child.tag == "PagedOctTree":
            found.shards.append(shard_entry(element, folder))
        elif child.tag == "Loss":
            found.losses.append((element.text("Name"), element.text("Reason")))
        elif child.tag != "OctTreeGroup":
            raise element.fail("", "is no element of a scene")
        elif element.has("GroupFile"):
            found.pages.append(page_entry(element, folder))
        else:
            nested = listing_of(element, folder)
            found.shards += nested.shards
            found.pages += nested.pages
            found.losses += nested.losses
    return found


def summed(counts: Sequence[Sequence[int]]) -> tuple[int, ...]:
    """Returns the sums of lists of different lengths, element by element."""
    length = max(map(len, counts), default=0)
    return tuple(sum(c[lod] for c in counts if lod < len(c)) for lod in range(length))


def sums_of(listing: Listing) -> tuple[int, tuple[int, ...]]:
    """Returns the number of cells, and of voxels per level of the lattice; duplicated levels do not count."""
    own = [(0,) * (s.first_lod + s.copied_lods) + s.voxels[s.copied_lods:] for s in listing.shards]
    cells = sum(s.first_lod == 0 for s in listing.shards) + sum(page.cells for page in listing.pages)
    return cells, summed([*own, *(page.voxels for page in listing.pages)])


def expect_sums(group: Element, listing: Listing, cells: int, voxels: tuple[int, ...]) -> None:
    """Raises an error unless the listed shards add up to the stated sums, each once."""
    found_cells, found_voxels = sums_of(listing)
    if found_cells != cells or found_voxels != voxels:
        raise group.fail("Voxels", f"the listed shards add up to {found_cells} cells and {found_voxels} voxels, "
                                   f"stated are {cells} and {voxels}")
    for what in ("name", "file"):
        listed = [getattr(shard, what) for shard in listing.shards]
        if len(set(listed)) != len(listed):
            raise group.fail("PagedOctTree", f"two shards have one {what}")


class SceneXml:
    """The header of a scene, the shards that scene.xml lists, and the pages below it, which are read on demand."""

    def __init__(self, file: Path) -> None:
        group = root_of(file)
        self.file = file
        self.version = group.integer("Version")
        if not OLDEST_SCENE_VERSION <= self.version <= NEWEST_SCENE_VERSION:
            raise group.fail("Version", f"is {self.version}; this package reads {OLDEST_SCENE_VERSION} to "
                                        f"{NEWEST_SCENE_VERSION}", NEWER_PROGRAM)
        self.generator = group.text("Generator")
        self.voxel_size_m = group.numbers("VoxelSize", 1)[0]
        self.lattice_origin_m = group.numbers("LatticeOrigin", 3)
        self.origin = group.numbers("Origin", 3) if group.has("Origin") else None
        self.channels = tuple(group.text("Channels").split())
        self.parameters = self._parameters(group)
        self.listing = listing_of(group, file.parent)
        self.cells, self.voxels = sums_of(self.listing)
        if self.version >= 2:
            self.cells, self.voxels = group.integer("Cells"), group.integers("Voxels")
        expect_sums(group, self.listing, self.cells, self.voxels)
        self.bounds = group.box("BoundsMin", "BoundsEnd")
        self.window = group.box("LatticeMin", "LatticeEnd")
        self._read_pages: dict[Path, Listing] = {}
        self._has_overviews = group.integer("Parents", 0) != 0
        self._edge = group.integer("CellVoxels", 0)

    @staticmethod
    def _parameters(group: Element) -> dict[str, Any]:
        try:
            parameters = json.loads(group.text("Parameters"))
        except ValueError as error:
            raise group.fail("Parameters", f"is not valid JSON: {error}") from error
        if not isinstance(parameters, dict):
            raise group.fail("Parameters", "expected a JSON object")
        return parameters

    def levels(self) -> int:
        """Returns the number of levels that exist in the whole scene, not only in some cells."""
        if self._has_overviews or self._edge or self.listing.pages:
            return len(self.voxels)
        return min((shard.lods for shard in self.listing.shards), default=0)

    def _page(self, page: PageEntry) -> Listing:
        """Returns the content of a page. Recent pages are kept: a page never changes once it has its name."""
        listing = self._read_pages.pop(page.file, None) or self._read_page(page)
        self._read_pages[page.file] = listing
        if len(self._read_pages) > MAX_PAGES_KEPT:
            del self._read_pages[next(iter(self._read_pages))]
        return listing

    def _read_page(self, page: PageEntry) -> Listing:
        group = root_of(page.file)
        version = group.integer("Version")
        if not 3 <= version <= NEWEST_SCENE_VERSION:
            raise group.fail("Version", f"is {version}; this package reads 3 to {NEWEST_SCENE_VERSION}", NEWER_PROGRAM)
        same = (group.numbers("VoxelSize", 1)[0] == self.voxel_size_m
                and group.numbers("LatticeOrigin", 3) == self.lattice_origin_m
                and tuple(group.text("Channels").split()) == self.channels
                and cube(group.index("BlockMin"), group.integer("BlockVoxels")) == page.block)
        if not same:
            raise group.fail("BlockMin", "is a page of another scene or block")
        listing = listing_of(group, self.file.parent)
        expect_sums(group, listing, page.cells, page.voxels)
        return listing

    def _below(self, listing: Listing, box: Box | None) -> Iterator[ShardEntry]:
        yield from listing.shards
        for page in listing.pages:
            if box is None or box.overlaps(page.block) or (page.window is not None and box.overlaps(page.window)):
                yield from self._below(self._page(page), box)

    def owners(self, lod: int, box: Box | None = None) -> Iterator[ShardEntry]:
        """Yields the shards that own a level, and whose windows overlap the box if there is one."""
        for shard in self._below(self.listing, box):
            if shard.owns(lod) and (box is None or box.overlaps(shard.window)):
                yield shard
