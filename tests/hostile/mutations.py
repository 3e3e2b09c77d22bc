"""Mutations of a source: its bytes, its numbers, its JSON."""
import re
import struct
import zlib

from source_seeds import Members, Raw, TooLong, members_of, text_of

NUMBERS = ["0", "-1", "1", "255", "65536", "16777216", "16777217", "2147483647", "2147483648", "4294967295",
           "4294967296", "9007199254740993", "18446744073709551616", "1e38", "1e39", "1e308", "-1e308", "1e999",
           "1e-320", "1.5", "-0.0", "0.1", "7" * 400, "7" * 20000, "0." + "3" * 5000, "NaN", "00"]
TEXTS = ["", "x" * 5000, "../../../../etc/passwd", "/etc/passwd", "/dev/zero", "/dev/stdin", "http://127.0.0.1:9/a.glb",
         "file:///etc/passwd", "%2e%2e/%2e%2e/etc/passwd", "a%00.glb", ".", "..", "t.json", "a.glb", "s.json",
         "\n\n\u0007", "ü" * 300, "data:application/octet-stream;base64,AAAA", "data:,",
         "+proj=longlat +nadgrids=/etc/passwd",
         "EPSG:0", "EPSG:25832", "GEOGCS[", "VEC3", "SCALAR", "BLEND", "REPLACE", "X", "2.0", "1.1"]
TELLING = [0, 1, 2, 0x7f, 0x80, 0xfe, 0xff]
WORDS = [0, 1, 2, 7, 255, 256, 65535, 65536, 1 << 24, (1 << 31) - 1, 1 << 31, (1 << 32) - 1, (1 << 32) - 8]


def place_in(content, rng):
    """Returns a position, in most cases near the front, which has the structure."""
    return rng.randrange(min(len(content), 256) if rng.random() < 0.5 else len(content))


def change_bytes(content, rng):
    content = bytearray(content)
    for _ in range(rng.randint(1, 6)):
        content[place_in(content, rng)] = rng.choice(TELLING) if rng.random() < 0.5 else rng.randrange(256)
    return bytes(content)


def flip_bit(content, rng):
    at = place_in(content, rng)
    return content[:at] + bytes([content[at] ^ 1 << rng.randrange(8)]) + content[at + 1:]


def cut_end(content, rng):
    return content[:rng.randrange(len(content))]


def cut_piece(content, rng):
    at = place_in(content, rng)
    return content[:at] + content[at + rng.randint(1, 64):]


def repeat_piece(content, rng):
    at = place_in(content, rng)
    return content[:at] + content[at:at + rng.randint(1, 64)] * rng.choice([2, 3, 100]) + content[at:]


def insert_noise(content, rng):
    at = place_in(content, rng)
    return content[:at] + rng.randbytes(rng.choice([1, 4, 100])) + content[at:]


def blank_piece(content, rng):
    at, size = place_in(content, rng), rng.randint(1, 64)
    return content[:at] + bytes([rng.choice(TELLING)]) * len(content[at:at + size]) + content[at + size:]


def change_word(content, rng):
    """Changes a number of four bytes, such as a length, count or offset, or a number of two bytes."""
    size = rng.choice([4, 4, 2])
    if len(content) < size:
        return content
    at = min(place_in(content, rng) // size * size, len(content) - size)
    form = rng.choice(["<", ">"]) + {4: "I", 2: "H"}[size]
    value = rng.choice(WORDS + [len(content), len(content) + 1]) % (1 << 8 * size)
    return content[:at] + struct.pack(form, value) + content[at + size:]


def change_digits(content, rng):
    found = list(re.finditer(rb"-?\d+(\.\d+)?([eE][-+]?\d+)?", content[:100_000]))
    if not found:
        return change_bytes(content, rng)
    number = rng.choice(found)
    return content[:number.start()] + rng.choice(NUMBERS).encode() + content[number.end():]


def change_line(content, rng):
    lines = content.split(b"\n")
    at = rng.randrange(len(lines))
    change = rng.choice(["drop", "twice", "many", "long", "join"])
    if change == "drop":
        lines.pop(at)
    elif change == "join":
        lines[at] += rng.choice(lines)
    else:
        lines[at:at] = [lines[at] * 1000] if change == "long" else [lines[at]] * {"twice": 1, "many": 5000}[change]
    return b"\n".join(lines)


def claim_picture_size(content, rng):
    """Returns a PNG with a valid header that claims another size."""
    if not content.startswith(b"\x89PNG") or len(content) < 33:
        return change_word(content, rng)
    head = bytearray(content[12:29])
    head[4:12] = struct.pack(">II", rng.choice(WORDS), rng.choice([1, 4, 1 << 14, 1 << 20]))
    return content[:12] + bytes(head) + struct.pack(">I", zlib.crc32(bytes(head))) + content[33:]


BYTE_CHANGES = [change_bytes, flip_bit, cut_end, cut_piece, repeat_piece, insert_noise, blank_piece, change_word,
                change_word, change_digits, change_line, claim_picture_size]


def slots_of(value, found, maximum=10_000):
    """Returns the places of a document, as (container, key)."""
    if len(found) > maximum:
        return found
    pairs = value.pairs if isinstance(value, Members) else list(enumerate(value)) if isinstance(value, list) else []
    for i, (_, inner) in enumerate(pairs):
        found.append((value, i))
        slots_of(inner, found)
    return found


def get(slot):
    owner, i = slot
    return owner.pairs[i][1] if isinstance(owner, Members) else owner[i]


def put(slot, value):
    owner, i = slot
    if isinstance(owner, Members):
        owner.pairs[i][1] = value
    else:
        owner[i] = value


def other_value(value, rng):
    """Returns a value of another type, or an extreme value."""
    if isinstance(value, (int, float)) and rng.random() < 0.8:
        return Raw(rng.choice(NUMBERS))
    if isinstance(value, str) and rng.random() < 0.8:
        return rng.choice(TEXTS)
    deep = rng.choice([5, 100, 5000])
    return rng.choice([None, True, [], Members([]), [[]] * 1000, Raw(rng.choice(NUMBERS)), rng.choice(TEXTS), [value],
                       [value] * 1000, Raw("[" * deep + "]" * deep), Raw('{"children":[' * deep + "]}" * deep)])


def change_json_once(document, rng):
    slots = slots_of(document, [])
    if not slots:
        return "nothing to change"
    slot = rng.choice(slots)
    owner, i = slot
    change = rng.choice(["value", "value", "value", "drop", "twice", "swap", "rename", "many"])
    if change == "value":
        put(slot, other_value(get(slot), rng))
    elif change == "swap":
        other = rng.choice(slots)
        mine, theirs = get(slot), get(other)
        put(slot, theirs), put(other, rng.choice([mine, 7]) if isinstance(mine, (Members, list)) else mine)
    elif isinstance(owner, list):
        owner[i:i + 1] = [] if change == "drop" else [owner[i]] * (20000 if change == "many" else 2)
    elif change == "drop":
        owner.pairs.pop(i)
    elif change == "rename":
        owner.pairs[i] = [rng.choice(TEXTS + [k for k, _ in owner.pairs]), owner.pairs[i][1]]
    else:
        owner.pairs.insert(i, [owner.pairs[i][0], other_value(get(slot), rng)])
    return change


def json_changed(value, rng):
    document = members_of(value)
    try:
        story = [change_json_once(document, rng) for _ in range(rng.choice([1, 1, 2, 4]))]
        return text_of(document).encode("utf-8", "surrogatepass"), story
    except (RecursionError, TooLong):
        return b"{}", ["nothing left"]


def mutant_of(seed, rng):
    """Returns the files of a mutant, and a description of the change."""
    names = sorted({*seed.files, *seed.documents})
    changed = rng.choice(names)
    files, story = dict(seed.files), ""
    for name, (value, wrap) in seed.documents.items():
        text = text_of(members_of(value)).encode()
        if name == changed and rng.random() < 0.6:
            text, changes = json_changed(value, rng)
            story = f"{name}: {changes}"
        files[name] = wrap(text)
    if not story:
        changes = [rng.choice(BYTE_CHANGES) for _ in range(rng.choice([1, 1, 2, 3]))]
        for change in changes:
            if files[changed]:
                is_long = len(files[changed]) > 100_000
                files[changed] = (change_bytes if is_long else change)(files[changed], rng)
        story = f"{changed}: {[c.__name__ for c in changes]}"
    if rng.random() < 0.02:
        files.pop(rng.choice(sorted(files)))
        story += ", one file missing"
    return files, story
