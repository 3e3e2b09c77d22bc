"""Writes implicit tiles with one content: subtrees as JSON or binary, availability as bits or as a constant."""
import json
import struct

CHILDREN = {"QUADTREE": 4, "OCTREE": 8}


def morton(level, place, dimensions):
    """Returns the Morton number of a tile in its level."""
    return sum((place[d] >> bit & 1) << (dimensions * bit + d) for bit in range(level) for d in range(dimensions))


def bits_of(numbers, length):
    out = bytearray((length + 7) // 8)
    for n in numbers:
        out[n // 8] |= 1 << n % 8
    return bytes(out)


class Subtree:
    """Availability of the tiles of one subtree."""

    def __init__(self, odd, levels, children):
        self.odd, self.levels, self.children = odd, levels, children
        self.tiles, self.contents, self.subtrees = set(), set(), set()
        self.first = [(children ** k - 1) // (children - 1) for k in range(levels + 1)]

    def write(self, folder, name, is_new):
        binary, views = b"", []

        def availability(numbers, length):
            nonlocal binary
            if not numbers or len(numbers) == length:
                return {"constant": int(bool(numbers))}
            data = bits_of(numbers, length)
            views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(data)})
            binary += data + bytes(-len(data) % 8)
            key = "bitstream" if is_new else "bufferView"
            return {key: len(views) - 1, **({"availableCount": len(numbers)} if self.odd.maybe() else {})}
        count = self.first[self.levels]
        content = availability(self.contents, count)
        document = {"tileAvailability": availability(self.tiles, count),
                    "contentAvailability": [content] if is_new else content,
                    "childSubtreeAvailability": availability(self.subtrees, self.children ** self.levels)}
        if views:
            document.update(bufferViews=views, buffers=[{"byteLength": len(binary)}])
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if self.odd.maybe():
            if views:
                document["buffers"][0]["uri"] = path.name + ".bin"
                (path.parent / (path.name + ".bin")).write_bytes(binary)
            path.write_text(json.dumps(document))
            return
        text = json.dumps(document).encode()
        text += b" " * (-len(text) % 8)
        path.write_bytes(b"subt" + struct.pack("<IQQ", 1, len(text), len(binary)) + text + binary)


def implicit_tile(odd, folder, number, data, suffix, is_new):
    """Stores a content as the one available content of an implicit tile. Returns the keys of the tile."""
    scheme = odd.choice(["QUADTREE", "OCTREE"])
    dimensions, children = (2, 4) if scheme == "QUADTREE" else (3, 8)
    subtree_levels = odd.randint(1, 3)
    level = odd.randint(0, 4)
    place = [odd.randrange(1 << level) for _ in range(dimensions)]
    base = f"i{number}"
    names = dict(zip("xyz", place), level=level)
    pattern = "{level}/{x}/{y}" + ("/{z}" if dimensions == 3 else "")
    path = folder / f"{base}/c/{pattern.format(**names)}.{suffix}"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data)
    for start in range(0, level + 1, subtree_levels):
        tree = Subtree(odd, subtree_levels, children)
        for k in range(start, min(level, start + subtree_levels - 1) + 1):
            inside = [p >> (level - k) & ((1 << (k - start)) - 1) for p in place]
            tree.tiles.add(tree.first[k - start] + morton(k - start, inside, dimensions))
        if level < start + subtree_levels:
            inside = [p & ((1 << (level - start)) - 1) for p in place]
            tree.contents.add(tree.first[level - start] + morton(level - start, inside, dimensions))
        else:
            inside = [p >> (level - start - subtree_levels) & ((1 << subtree_levels) - 1) for p in place]
            tree.subtrees.add(morton(subtree_levels, inside, dimensions))
        root = [p >> (level - start) for p in place]
        tree.write(folder, f"{base}/s/" + pattern.format(level=start, **dict(zip("xyz", root))) + ".subtree", is_new)
    tiling = {"subdivisionScheme": scheme, "subtreeLevels": subtree_levels,
              "availableLevels" if is_new else "maximumLevel": level + 1 if is_new else level,
              "subtrees": {"uri": f"{base}/s/{pattern}.subtree"}}
    content = {"content": {"uri": f"{base}/c/{pattern}.{suffix}"}}
    if is_new:
        return {"implicitTiling": tiling, **content}
    return {"extensions": {"3DTILES_implicit_tiling": tiling}, **content}
