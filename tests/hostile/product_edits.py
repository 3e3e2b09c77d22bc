"""Random edits of a bake's results."""
import ctypes
import re
import shutil
from pathlib import Path

import h5py
import numpy

ODD_VALUES = ("", "nan", "-nan", "inf", "-1", "0", "1", "1e308", "-1e308", "1e-320", "18446744073709551615",
              "18446744073709551616", "9" * 400, "x", "0x10", "1 2", "1 2 3 4 5 6 7 8", " ", "&#10;", "&lt;a&gt;",
              "../x", "/etc/passwd", "true", "{}", "[]", "ä" * 200, "a b", "NaN NaN NaN", "1,5", "+3", "1.0", "٣")


class Edit:
    """A description of a change, and its consequences for the expected results."""

    def __init__(self, what, loses_cells=False, bars_baking=False):
        self.what, self.loses_cells, self.bars_baking = what, loses_cells, bars_baking


class Xxh128(ctypes.Structure):
    _fields_ = [("low", ctypes.c_uint64), ("high", ctypes.c_uint64)]


def xxh3_128(data):
    library = ctypes.CDLL("libxxhash.so.0")
    library.XXH3_128bits.restype = Xxh128
    library.XXH3_128bits.argtypes = [ctypes.c_char_p, ctypes.c_size_t]
    h = library.XXH3_128bits(data, len(data))
    return f"{h.high:016x}{h.low:016x}"


def with_checksum(text):
    """Returns the text with a valid checksum, like an attacker with docs/format.md would write it."""
    zeroed = re.sub(r'( Checksum=")[0-9a-f]{32}(")', rf'\g<1>{"0" * 32}\g<2>', text, count=1)
    return zeroed.replace(f' Checksum="{"0" * 32}"', f' Checksum="{xxh3_128(zeroed.encode())}"', 1)


def as_version_1(text):
    text = re.sub(r' Cells="[^>]*?(?=>)', "", text, count=1)
    text = re.sub(r' (LevelBytes|NodeBytes)="[^"]*"', "", text)
    return text.replace('Version="4"', 'Version="1"', 1)


# scene.xml


def edit_attribute(rng, text):
    found = list(re.finditer(r' ([A-Za-z]+)="([^"]*)"', text))
    a = rng.choice(found)
    others = [b for b in found if b.group(1) == a.group(1) and b.group(2) != a.group(2)] or found
    value = a.group(2)
    at = rng.randrange(len(value)) if value else 0
    kinds = {
        "removed": "",
        "odd": f' {a.group(1)}="{rng.choice(ODD_VALUES)}"',
        "of another": f' {a.group(1)}="{rng.choice(others).group(2)}"',
        "one digit": f' {a.group(1)}="{value[:at]}{rng.randrange(10)}{value[at + 1:]}"',
        "negative": f' {a.group(1)}="-{value}"',
        "longer": f' {a.group(1)}="{value} {value}"',
        "twice": a.group(0) * 2,
        "renamed": a.group(0).replace(a.group(1), a.group(1) + "2"),
    }
    kind = rng.choice(list(kinds))
    return text[:a.start()] + kinds[kind] + text[a.end():], f"{a.group(1)} {kind}: {kinds[kind][:80]}", False


def edit_line(rng, text):
    lines = text.splitlines(keepends=True)
    cells = [i for i, line in enumerate(lines) if "<PagedOctTree" in line]
    i, j = rng.choice(cells), rng.choice(cells)
    kind = rng.choice(("lost", "double", "swapped", "all lost", "commented", "nested", "renamed", "copy of another"))
    if kind == "lost":
        del lines[i]
    elif kind == "double":
        lines.insert(j, lines[i])
    elif kind == "swapped":
        lines[i], lines[j] = lines[j], lines[i]
    elif kind == "all lost":
        lines = [line for line in lines if "<PagedOctTree" not in line]
    elif kind == "commented":
        lines[i] = f"<!-- {lines[i].strip()} -->\n"
    elif kind == "nested":
        lines[i] = f"<OctTreeGroup>{lines[i].strip()}</OctTreeGroup>\n"
    elif kind == "renamed":
        lines[i] = lines[i].replace("PagedOctTree", "PagedOctTre")
    else:
        lines[i] = lines[j]
    return "".join(lines), f"line {i} {kind} ({j})", kind in ("lost", "all lost", "commented", "renamed")


def edit_shard_names(rng, text):
    names = re.findall(r'TreeFile="([^"]*)"', text)
    a, b = rng.sample(names, 2)
    return text.replace(a, "\0").replace(b, a).replace("\0", b), f"TreeFile {a} and {b} swapped", False


def edit_bytes(rng, text):
    data = bytearray(text.encode())
    at = rng.randrange(len(data))
    kind = rng.choice(("flip", "cut", "grow", "insert"))
    if kind == "flip":
        data[at] ^= 1 << rng.randrange(8)
    elif kind == "cut":
        del data[at:]
    elif kind == "grow":
        data += data[:at]
    else:
        entity = b"<!DOCTYPE a [<!ENTITY b SYSTEM 'file:///etc/passwd'>]>"
        data[at:at] = rng.choice((b"<", b">", b"\0", b"&", b'"', entity))
    return bytes(data).decode("utf-8", "surrogateescape"), f"scene.xml {kind} at {at}", False


def edit_scene(rng, out, _other):
    path = out / "scene.xml"
    text = path.read_text()
    is_old = rng.random() < 0.2
    if is_old:
        text = as_version_1(text)
    how = rng.choice((edit_attribute, edit_attribute, edit_attribute, edit_line, edit_shard_names, edit_bytes))
    text, what, loses_cells = how(rng, text)
    fits = rng.random() < 0.6
    if fits and how is not edit_bytes:
        text = with_checksum(text)
    path.write_bytes(text.encode("utf-8", "surrogateescape"))
    return Edit(f"{what}{', version 1' if is_old else ''}{', checksum fits' if fits else ''}", loses_cells)


# shards


def shards_of(out):
    return sorted((out / "shards").glob("*.h5"))


def edit_shard_bytes(rng, out, _other):
    shard = rng.choice(shards_of(out))
    data = bytearray(shard.read_bytes())
    kind = rng.choice(("flips", "cut", "grow", "zeros", "block"))
    at = rng.randrange(len(data))
    if kind == "flips":
        for _ in range(rng.choice((1, 1, 2, 8))):
            data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
    elif kind == "cut":
        del data[at:]
    elif kind == "grow":
        data += bytes(rng.randrange(256) for _ in range(64))
    elif kind == "zeros":
        data[at:at + 64] = bytes(len(data[at:at + 64]))
    else:
        there = rng.randrange(len(data))
        data[at:at + 256] = data[there:there + len(data[at:at + 256])]
        del data[shard.stat().st_size:]
    shard.write_bytes(data)
    return Edit(f"{shard.name} {kind} at {at}")


def edit_shard_files(rng, out, other):
    a, b = rng.sample(shards_of(out), 2)
    kind = rng.choice(("swapped", "copy", "lost", "other scene", "link", "folder", "empty"))
    if kind == "swapped":
        bytes_a, bytes_b = a.read_bytes(), b.read_bytes()
        a.write_bytes(bytes_b)
        b.write_bytes(bytes_a)
    elif kind == "copy":
        shutil.copy(a, b)
    elif kind == "lost":
        a.unlink()
    elif kind == "other scene":
        of_cell = {shard.name.split("-")[0]: shard for shard in shards_of(other)}
        shutil.copy(of_cell.get(a.name.split("-")[0], shards_of(other)[0]), a)
    elif kind == "link":
        a.unlink()
        a.symlink_to(b)
    elif kind == "folder":
        a.unlink()
        a.mkdir()
    else:
        a.write_bytes(b"")
    return Edit(f"shard {kind}: {a.name} {b.name}", bars_baking=kind == "folder")


def edit_dataset(rng, group):
    names = []
    group.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) and item.size else None)
    name = rng.choice(names)
    values = group[name][()]
    flat = values.reshape(-1)
    at = rng.randrange(len(flat))
    before = flat[at]
    with numpy.errstate(all="ignore"):
        flat[at] = rng.choice((flat[at] ^ numpy.array(1, flat.dtype), flat[rng.randrange(len(flat))],
                               numpy.array(0, flat.dtype), numpy.iinfo(flat.dtype).max))
    group[name][...] = values
    return f"{name}[{at}] {before} to {flat[at]}"


def edit_shard_attribute(rng, shard):
    name = rng.choice(sorted(shard.attrs))
    kind = rng.choice(("removed", "odd", "changed"))
    value = shard.attrs[name]
    if kind == "removed":
        del shard.attrs[name]
    elif kind == "odd":
        del shard.attrs[name]
        odd = numpy.float64("nan"), numpy.int64(-1), numpy.bytes_(b"x" * 500), numpy.zeros(9)
        shard.attrs[name] = rng.choice(odd)
    elif isinstance(value, (bytes, numpy.bytes_)):
        text = bytearray(bytes(value))
        text[rng.randrange(len(text))] ^= 1
        shard.attrs.modify(name, numpy.bytes_(bytes(text)))
    else:
        numbers = numpy.array(value)
        numbers.reshape(-1)[rng.randrange(numbers.size)] += numpy.array(rng.choice((1, 8, -8))).astype(numbers.dtype)
        shard.attrs.modify(name, numbers)
    return f"attribute {name} {kind}"


def edit_shard_content(rng, out, _other):
    """Edits through the library, so that HDF5's checksums are valid; size and checksum in the scene are adapted."""
    path = rng.choice(shards_of(out))
    with h5py.File(path, "r+", libver="latest") as shard:
        how = rng.choice((edit_dataset, edit_dataset, edit_shard_attribute))
        what = how(rng, shard)
    scene = out / "scene.xml"
    # Removes the optional sizes of columns, which would reveal an edit before its voxels do.
    text = re.sub(r' (LevelBytes|NodeBytes)="[^"]*"', "", scene.read_text())
    line = next(line for line in text.splitlines() if path.name in line)
    fitting = re.sub(r' Bytes="\d+"', f' Bytes="{path.stat().st_size}"', line)
    text = text.replace(line, fitting)
    total = sum(int(size) for size in re.findall(r'<PagedOctTree [^>]* Bytes="(\d+)"', text))
    text = re.sub(r' Bytes="\d+"', f' Bytes="{total}"', text, count=1)  # the root's size comes first
    scene.write_text(with_checksum(text))
    return Edit(f"{path.name} {what}")


# files that save work in the next bake


def edit_record(rng, out, _other):
    files = [f for f in sorted(out.iterdir()) if f.is_file() and f.name != "scene.xml"]
    path = rng.choice(files)
    data = bytearray(path.read_bytes())
    kind = rng.choice(("flips", "cut", "grow", "empty", "lost", "folder", "random", "double"))
    if kind == "flips":
        for _ in range(rng.choice((1, 1, 4, 32)) if data else 0):
            data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
    elif kind == "cut":
        del data[rng.randrange(len(data) + 1):]
    elif kind == "grow":
        data += bytes(rng.randrange(256) for _ in range(100))
    elif kind == "empty":
        data.clear()
    elif kind == "random":
        data = bytearray(rng.randrange(256) for _ in range(len(data)))
    elif kind == "double":
        data += bytes(data)
    path.unlink()
    if kind == "folder":
        path.mkdir()
    elif kind != "lost":
        path.write_bytes(data)
    return Edit(f"{path.name} {kind}", bars_baking=kind == "folder")


def edit(rng, out, other):
    """Applies a random edit. other: a bake of another scene with cells of the same names."""
    how = rng.choice((edit_scene, edit_scene, edit_scene, edit_shard_bytes, edit_shard_files, edit_shard_content,
                      edit_shard_content, edit_record))
    return how(rng, Path(out), Path(other))
