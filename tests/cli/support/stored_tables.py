"""Tables of measured values, as tools/figures makes them from the JSON output of a benchmark."""
import sys
from pathlib import Path


def table_of(source, name, bench):
    """Returns the Markdown lines of the rows that tools/figures --measure would store for a table."""
    sys.dont_write_bytecode = True
    sys.path.insert(0, str(Path(source) / "tools"))
    from figures_lib import data, markdown, measure
    table = data.load(name)
    return markdown.table_text(table["columns"], measure.rows_of_result(table, [bench])).splitlines()[2:]
