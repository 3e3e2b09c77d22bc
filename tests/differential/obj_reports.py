"""Statements of an OBJ or MTL that a bake does not use and must report."""

NO_UV = "faces without texture coordinates, of materials with an image"
LOST_VERTEX = "faces left out, since a corner refers to no vertex"
LOST_NUMBER = "faces left out, since a corner is not a number"
SHORT_VERTEX = "vertices without three coordinates, whose faces are left out"
UNKNOWN = "lines not understood"
FREE_FORM = "lines of free-form curves and surfaces, which are not baked"
INVISIBLE = "materials with alpha 0, whose faces are invisible"
BRIGHT = "colours (Kd) above 1, taken as 1"
FORM_LINES = ("cstype bspline", "deg 3", "parm u 0 1", "curv 0 1 1 2 3", "end")


def add_reported(writer):
    """Adds lines of up to two faulty forms at the end, after all vertices."""
    odd, case, lines = writer.odd, writer.case, writer.lines
    kinds = ["twice", "flat", "few", "vertex", "number", "unknown", "form", "short"]
    if writer.is_coloured or NO_UV in writer.warned:
        kinds = kinds[2:]  # these faces would be reported as faces without colours or texture coordinates
    for kind in sorted(odd.sample(kinds, odd.randint(0, 2)), key=kinds.index):
        count = odd.randint(1, 3)
        if kind == "vertex":
            lines += [odd.choice(["f 1 2 99999", f"f 1 2 -{writer.vertices + 1}", "f 0 1 2"]) for _ in range(count)]
            case.losses.append(LOST_VERTEX)
        if kind == "number":
            lines += [odd.choice(["f 1 2 x", "f a b c", "f 1 2 /3"]) for _ in range(count)]
            case.losses.append(LOST_NUMBER)
        if kind == "short":
            lines += [odd.choice(["v 1 2", "v", "v 1 x 3"]) for _ in range(count)]
            case.losses.append(SHORT_VERTEX)
        if kind == "unknown":
            lines += [odd.choice(["xyzzy 1 2", "vertex 1 2 3", "<html>"]) for _ in range(count)]
            writer.warn(UNKNOWN, count)
        if kind == "form":
            lines += FORM_LINES
            writer.warn(FREE_FORM, len(FORM_LINES))
        if kind == "few":
            lines += ["f 1"] * count + ["f 1 2"]
            case.skipped_points += count
            case.skipped_lines += 1
        if kind == "flat":
            lines += ["usemtl"] + ["f -1 -1 -2"] * count
            case.triangles += count
        if kind == "twice":
            add_twice(lines, case)


def add_twice(lines, case):
    """Repeats the last face, if it is one line with positive indices."""
    last = lines[-1]
    if last.startswith("f ") and "-" not in last and "#" not in last and not lines[-2].endswith("\\"):
        lines.append(last)
        case.triangles += len(last.split()) - 3
