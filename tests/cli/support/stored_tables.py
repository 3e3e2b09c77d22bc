"""Tables of measured values, as tools/figures makes them from the JSON output of a benchmark."""
import importlib.machinery
import importlib.util
import sys
from pathlib import Path


def table_of(source, name, bench):
    """Returns the Markdown lines of the rows that tools/figures --measure would store in docs/data/NAME.json."""
    sys.dont_write_bytecode = True
    loader = importlib.machinery.SourceFileLoader("figures", str(Path(source) / "tools/figures"))
    figures = importlib.util.module_from_spec(importlib.util.spec_from_loader("figures", loader))
    loader.exec_module(figures)
    data = figures.load(name)
    data["rows"] = figures.rows_of(data, bench)
    return figures.table(data).splitlines()[2:]
