"""Rows of the tables whose benchmarks report more than one list of equal items."""
from figures_lib.markdown import cell_text
from figures_lib.values import six_digits


def hard_figure(figure):
    """Returns the measured value and its bound; lengths in millimetres."""
    factor = 1000 if figure["unit"] == "m" else 1
    measured = 0 if factor == 1 and abs(figure["measured"]) < 1e-9 else factor * figure["measured"]
    return [six_digits(measured), six_digits(factor * figure["bound"])]


def hard_row(columns, name, cases):
    """Returns the row of a case, or of the maxima of several cases. The last column has all other values."""
    figures = {}
    for case in cases:
        for key, figure in case["figures"].items():
            figures[key] = max(figures.get(key, figure), figure, key=lambda one: one["measured"])
    shown = [column["name"] for column in columns[2:-1]]
    more = [f"{key} {cell_text(columns[2], hard_figure(figure))} {figure['unit']}".rstrip()
            for key, figure in figures.items() if key not in shown]
    cells = [hard_figure(figures[key]) if key in figures else None for key in shown]
    return [name, sum(case["voxels"] for case in cases), *cells, "; ".join(more) or None]


def hard_rows(table, result):
    """Returns a row per group of ties, leaves and classes, and a row per other case."""
    groups = {}
    for case in result["cases"]:
        if case["group"] == "surfaces":
            continue
        is_grouped = case["group"].startswith("ties") or case["group"] in ("leaves", "planes of leaves", "classes")
        groups.setdefault(case["group"] if is_grouped else f"`{case['name']}`", []).append(case)
    return [hard_row(table["columns"], f"{name}: the worst of {len(cases)}" if len(cases) > 1 else name, cases)
            for name, cases in groups.items()]


def range_text(low, high):
    return f"{low:.3g} to {high:.3g}" if low > 0 else f"≤ {high:.3g}"


def joined(texts):
    """Returns the texts as one, or the first text if all are equal."""
    return texts[0] if len(set(texts)) == 1 else "; ".join(texts)


def surface_rows(_, result):
    """Returns a row per case of surfaces: its values, their bounds and goals. Values that meet their goal are bold."""
    rows = []
    for case in (case for case in result["cases"] if case["group"] == "surfaces"):
        figures = case["figures"]
        rows.append([f"`{case['name']}`",
                     joined([", ".join(filter(None, (name, one["unit"]))) for name, one in figures.items()]),
                     joined([f"{'**' * one['meets_goal']}{one['measured']:.3g}{'**' * one['meets_goal']}"
                             for one in figures.values()]),
                     joined([range_text(one["at_least"], one["bound"]) for one in figures.values()]),
                     joined([range_text(*one["goal"]) for one in figures.values()])])
    return rows


def motion_rows(_, result):
    """Returns a row without and a row with blended levels."""
    return [[f"`--level-blend {name}`{note}", six_digits(result["worst_ratio" + key]),
             six_digits(max(pair[part]["worst_block"] for pair in result["pairs"])),
             six_digits(result["mean_still" + key])]
            for name, note, key, part in (("off", " (default)", "", "plain"), ("on", "", "_blended", "blended"))]


def leak_rows(_, result):
    """Returns a row per class of opaque scenes, with the worst image of at least 100 pixels, and a row of all."""
    families = {}
    for scene in result["scenes"]:
        if scene["opaque"]:
            families.setdefault(scene["family"], []).extend(row for row in scene["rows"] if row["inner_pixels"])
    bounds, rows = result["bounds"], []
    for name, images in families.items():
        bad = [image for image in images if image["below_99"] > bounds["max_below_99"]
               or image["min_alpha"] < bounds["min_alpha"]]
        worst = max((image for image in bad if image["inner_pixels"] >= 100), default=None,
                    key=lambda image: (image["below_99"], -image["min_alpha"]))
        text = f"{100 * worst['below_99']:.1f} % of the pixels, least {worst['min_alpha']:.2f}" if worst else None
        rows.append([name, [len(images) - len(bad), len(images)], text])
    return [*rows, ["all", [sum(row[1][i] for row in rows) for i in (0, 1)], None]]


def texture_rows(_, result):
    """Returns a row per texture of the tests: the errors of a square, whole and cut into triangles."""
    suite = next(suite for suite in result["testsuites"] if suite["name"] == "Cases/Textures")
    rows = []
    for case in suite["testsuite"]:
        name = case["name"].partition("/")[2].replace("_", " ")
        errors = [float(case[key]) for key in ("worst", "worst_cut", "mean", "mean_cut")]
        rows.append([name, *errors, max(float(case["bias"]), float(case["bias_cut"]))])
    return rows


READERS = {"hard cases": hard_rows, "surfaces": surface_rows, "motion": motion_rows, "leaks": leak_rows,
           "textures": texture_rows}
