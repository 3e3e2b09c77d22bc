"""Writes ESRI ASCII grids in the spellings of different programs."""


def ascii_grid(odd, values, left, top, pixel, nodata):
    """Returns the text of a grid. left, top: its upper left corner; nodata: None, or a number."""
    rows, columns = values.shape
    low = top - rows * pixel
    is_upper = odd.choice([str, str, str.upper, str.lower])
    head = [("ncols", columns), ("nrows", rows)]
    if odd.maybe(0.3):
        head += [("xllcenter", repr(left + pixel / 2)), ("yllcenter", repr(low + pixel / 2))]
    else:
        head += [("xllcorner", repr(left)), ("yllcorner", repr(low))]
    head.append(("cellsize", repr(pixel)))
    if nodata is not None:
        head.append(("NODATA_value", odd.choice([repr(nodata), f"{nodata:.10g}"])))
    gap = odd.choice([" ", "  ", "         ", "\t"])
    lines = [is_upper(key) + gap + str(value) for key, value in head]
    is_whole = values.dtype.kind in "iu"
    words = [[str(v) if is_whole else odd.choice([repr(float(v)), f"{v:.9e}", f"{v:.9g}"]) for v in row]
             for row in values.tolist()]
    if odd.maybe(0.15):
        flat = [w for row in words for w in row]
        step = odd.randint(1, columns)
        words = [flat[i:i + step] for i in range(0, len(flat), step)]
    between = odd.choice([" ", " ", "  ", "\t"])
    before = odd.choice(["", "", " "])
    lines += [before + between.join(row) + odd.choice(["", " "]) for row in words]
    end = odd.choice(["\n", "\n", "\r\n"])
    return end.join(lines) + (end if odd.maybe(0.9) else "")
