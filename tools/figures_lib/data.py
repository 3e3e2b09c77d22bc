"""Files of docs/data: FOLDER/NAME.json defines a table, MACHINE.json has the rows that one machine measured."""
import json
import re
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent.parent
DATA = TOP / "docs/data"
TABLE_KEYS = ["title", "note", "prepare", "commands", "repeats", "runs", "quick", "by_name", "measured", "machine", "commit",
              "version", "date", "columns", "rows"]
REQUIRED = {"title", "commands", "measured", "columns"}
RUN_KEYS = ["commit", "version", "card", "driver", "processor", "cores", "files", "date", "tables"]


class Problem(Exception):
    """An error in the data, a document or a measurement, as a line for the user."""


def load_json(path):
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise Problem(f"{path.relative_to(TOP) if path.is_relative_to(TOP) else path}: {error}") from error


def table_files():
    """Returns a table from the name of each table to its file."""
    return {path.stem: path for path in sorted(DATA.glob("*/*.json"), key=lambda path: path.stem)}


def load(name):
    """Returns the definition of a table after checking its keys."""
    path = table_files().get(name)
    if path is None:
        raise Problem(f"docs/data has no table {name}: expected one of {', '.join(table_files())}")
    table = load_json(path)
    if not REQUIRED <= set(table) <= set(TABLE_KEYS):
        raise Problem(f"table {name}: expected the keys {sorted(REQUIRED)}; optional: "
                      f"{sorted(set(TABLE_KEYS) - REQUIRED)}")
    if (table["measured"] == "by hand" or "copies" in table["measured"]) == ("runs" in table):
        raise Problem(f"table {name}: expected either `runs`, `copies` or `\"measured\": \"by hand\"`")
    return table


def machine_names():
    return sorted(path.stem for path in DATA.glob("*.json"))


def load_machine(name, path=None):
    """Returns the content of docs/data/NAME.json, or of another file. A machine without a file has no runs."""
    path = path or DATA / f"{name}.json"
    if not path.exists():
        return {"machine": name, "runs": []}
    machine = load_json(path)
    if set(machine) != {"machine", "runs"} or any(set(run) != set(RUN_KEYS) for run in machine["runs"]):
        raise Problem(f"{path.name}: expected the keys `machine` and `runs`, in each run {RUN_KEYS}")
    return machine


def run_of(machine, name):
    """Returns the run of a machine that measured a table, or None."""
    return next((run for run in machine["runs"] if name in run["tables"]), None)


def runs_of(name):
    """Returns the runs that measured a table, one per machine, or None until all its machines have measured it."""
    runs = [run_of(load_machine(machine), name) for machine in load(name).get("runs", {})]
    return runs if runs and None not in runs else None


def machine_text(run):
    """Returns a machine in few words: card and cores."""
    return f"one {run['card']}, {run['cores']} cores" if run["card"] else f"{run['cores']} cores"


def copied_cell(source, name, row):
    """Returns a cell of another table: that of a column, the machine, or a text after `= `."""
    table, runs = load(source), runs_of(source)
    if name is None or name.startswith("= "):
        return name and name[2:]
    if name == "machine":
        return machine_text(runs[0]) if runs else table["machine"]
    names = [column["name"] for column in table["columns"]]
    if name not in names:
        raise Problem(f"table {source}: no column {name}")
    return row[names.index(name)]


def copied_rows(table):
    """Returns rows with cells of other tables. A machine is named in its first row."""
    rows = []
    for source, numbers in table["measured"]["copies"].items():
        for number in numbers:
            row = rows_of(source)[number]
            names = [column["copies"].get(source) for column in table["columns"]]
            rows.append([None if name == "machine" and number != numbers[0] else copied_cell(source, name, row)
                         for name in names])
    return rows


def rows_of(name):
    """Returns the rows of a table: measured ones, otherwise those that its definition keeps until a measurement."""
    table, runs = load(name), runs_of(name)
    if "copies" in table["measured"]:
        return copied_rows(table)
    if runs is None and "rows" not in table:
        raise Problem(f"table {name}: not measured; run tools/figures --measure {name} on the machines "
                      f"{', '.join(table['runs'])}")
    if runs is not None and "rows" in table:
        raise Problem(f"table {name}: has rows, and a machine measured the table")
    rows = table["rows"] if runs is None else [row for run in runs for row in run["tables"][name]]
    for row in rows:
        if len(row) != len(table["columns"]):
            raise Problem(f"{name}: expected {len(table['columns'])} cells, not {row}")
    return rows


def is_nested(value):
    """Returns True for a list of lists or objects, and for an object with such a value."""
    if isinstance(value, dict):
        return any(is_nested(item) for item in value.values())
    return isinstance(value, list) and value != [] and all(isinstance(item, (list, dict)) for item in value)


def text_of(value, depth=0):
    """Returns JSON text. Lists of objects or rows have a line per item unless they fit into one line."""
    line = json.dumps(value, ensure_ascii=False)
    if depth > 0 and (len(line) + depth <= 118 or not is_nested(value)):
        return line
    if isinstance(value, dict):
        lines = [f"{json.dumps(key)}: {text_of(item, depth + 1)}" for key, item in value.items()]
    else:
        lines = [text_of(item, depth + 1) for item in value]
    space, marks = "\n" + " " * depth, "{}" if isinstance(value, dict) else "[]"
    return marks[0] + ",".join(f"{space} {item}" for item in lines) + space + marks[1]


def store(path, value):
    path.write_text(text_of(value) + "\n", encoding="utf-8")


def store_table(name, table):
    store(table_files()[name], dict(sorted(table.items(), key=lambda item: TABLE_KEYS.index(item[0]))))


def merged(machine, run):
    """Returns the content of a machine's file with the tables of a run in place of earlier rows of these tables."""
    runs = []
    for earlier in machine["runs"]:
        tables = {name: rows for name, rows in earlier["tables"].items() if name not in run["tables"]}
        if tables:
            runs.append({**earlier, "tables": tables})
    same = next((one for one in runs if all(one[key] == run[key] for key in RUN_KEYS if key != "tables")), None)
    if same:
        same["tables"] = {**same["tables"], **run["tables"]}
    return {"machine": machine["machine"], "runs": runs if same else [*runs, run]}


def forget_old(names):
    """Removes tables from the list of tables that are older than the measured code allows."""
    path = TOP / "tests/architecture/old_tables.txt"
    if path.exists():
        lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
        path.write_text("".join(line for line in lines if line.partition(" ")[0].strip() not in names), encoding="utf-8")


def take(path):
    """Adds the runs of a file to docs/data/MACHINE.json. Removes rows from definitions of tables now measured."""
    taken = load_machine(None, path)
    if not re.fullmatch(r"[\w-]+", taken["machine"]):
        raise Problem(f"{path}: expected the name of a machine, not {taken['machine']}")
    machine = load_machine(taken["machine"])
    for run in taken["runs"]:
        machine = merged(machine, run)
    store(DATA / f"{taken['machine']}.json", machine)
    names = {name for run in taken["runs"] for name in run["tables"]}
    for name in names:
        table = load(name)
        if "rows" in table and runs_of(name) is not None:
            store_table(name, {key: value for key, value in table.items()
                               if key not in ("rows", "machine", "commit", "version", "date")})
    forget_old(names)
