"""Tables and machines as Markdown in the documents."""
import re
import textwrap

from figures_lib import data
from figures_lib.data import TOP, Problem

BEGIN = re.compile(r"^<!-- data/(.*?)\.json -->$", re.M)
BLOCK = re.compile(r"^(<!-- data/((?:[\w-]+/)?[\w-]+)\.json -->\n).*?^(<!-- end -->)$", re.M | re.S)
HASH = re.compile(r"[0-9a-f]{32}")


def scalar_text(pattern, value):
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, str):
        return value[:8] + "…" if HASH.fullmatch(value) else value
    return "" if value is None else pattern.format(value)


def cell_text(column, cell):
    """Returns the text of a cell in a document."""
    if not isinstance(cell, list):
        pattern = column.get("format", "{}")
        return scalar_text(pattern if pattern.count("{") == 1 else "{}", cell)
    pattern = column.get("format", "{}")
    if pattern.count("{") == 1:
        return (" to " if column.get("spread") else "; ").join(scalar_text(pattern, value) for value in cell)
    return pattern.format(*cell) if pattern.count("{") == len(cell) else "; ".join(map(str, cell))


def table_text(columns, rows):
    """Returns a Markdown table."""
    heads = [", ".join(filter(None, (column["name"], column.get("unit")))) for column in columns]
    lines = [heads, ["---"] * len(heads)]
    lines += [[cell_text(*pair) for pair in zip(columns, row)] for row in rows]
    return "".join("|" + "".join(f" {cell} |" if cell else " |" for cell in line) + "\n" for line in lines)


def host_text(run):
    """Returns the machine of a run: card, driver, cores and processor."""
    card = f"one {run['card']} (driver {run['driver']}), " if run["card"] else ""
    return f"{card}{run['cores']} cores" + (f" of {run['processor']}" if run["processor"] else "")


def run_text(run):
    files = f", files {run['files']}" if run["files"] else ""
    return f"{host_text(run)}{files}; {run['version']}, commit {run['commit']}"


def earlier_tables(name):
    """Returns the tables of a machine whose rows come from earlier commands, with the machine that these rows name."""
    tables = {one: data.load(one) for one in data.table_files()}
    return [f"{one} ({table.get('machine', 'machine unknown')})" for one, table in tables.items()
            if name in table.get("runs", {}) and "rows" in table]


def machine_block(machine):
    """Returns a line per run that names its tables, machine and commit, and a line of tables not measured since."""
    runs, earlier = machine["runs"], earlier_tables(machine["machine"])
    lines = [f"- {', '.join(sorted(run['tables'])) if len(runs) > 1 else 'All tables'}: {run_text(run)}."
             for run in runs]
    if earlier:
        lines.append(f"- Rows of earlier commands and commits: {', '.join(earlier)}.")
    return "".join(textwrap.fill(line, 120, subsequent_indent="  ", break_on_hyphens=False) + "\n" for line in lines)


def block_text(name):
    """Returns the text of a block from its data."""
    if "/" in name:
        table = name.rpartition("/")[2]
        return table_text(data.load(table)["columns"], data.rows_of(table))
    return machine_block(data.load_machine(name))


def rewritten(text):
    """Returns a document with the blocks of the data."""
    return BLOCK.sub(lambda found: f"{found[1]}\n{block_text(found[2])}\n{found[3]}", text)


def documents():
    """Returns a table from each document to its text."""
    paths = sorted([*TOP.glob("*.md"), *(TOP / "docs").rglob("*.md")])
    return {path: path.read_text(encoding="utf-8") for path in paths}


def page_problems(page, text):
    """Yields a line for each block of a page that differs from its data, and for each error in its markers."""
    blocks = list(BLOCK.finditer(text))
    if BEGIN.findall(text) != [found[2] for found in blocks] or text.count("<!-- end -->") != len(blocks):
        yield f"{page}: expected `<!-- end -->` after the table of each `<!-- data/FOLDER/NAME.json -->`"
    for found in blocks:
        try:
            if found[0] != rewritten(found[0]):
                yield f"{page}: the table {found[2]} differs from docs/data/{found[2]}.json: run tools/figures"
        except Problem as problem:
            yield f"{page}: {problem}"


def problems():
    """Yields a line for each error in the documents and the data."""
    used = []
    for path, text in documents().items():
        yield from page_problems(path.relative_to(TOP), text)
        used += [found[2] for found in BLOCK.finditer(text)]
    stored = [path.relative_to(data.DATA).with_suffix("").as_posix() for path in data.DATA.rglob("*.json")]
    yield from (f"docs/data/{name}.json: no document shows it" for name in sorted(set(stored) - set(used)))
    yield from (f"docs/data/{name}.json: two tables show it" for name in sorted(set(used))
                if "/" in name and used.count(name) > 1)
    for machine in data.machine_names():
        for run in data.load_machine(machine)["runs"]:
            yield from (f"docs/data/{machine}.json: there is no table {name} of this machine" for name in run["tables"]
                        if name not in data.table_files() or machine not in data.load(name).get("runs", {}))


def write_documents():
    for path, text in documents().items():
        if rewritten(text) != text:
            path.write_text(rewritten(text), encoding="utf-8")
            print(f"wrote {path.relative_to(TOP)}")
