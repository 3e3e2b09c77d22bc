"""Tables of measured values, as tools/figures makes them from the JSON output of a benchmark."""
from tool_module import tool_module


def table_of(source, name, bench):
    """Returns the Markdown lines of the rows that tools/figures --measure would store in docs/data/NAME.json."""
    figures = tool_module(source, "figures")
    data = figures.load(name)
    data["rows"] = figures.rows_of(data, bench)
    return figures.table(data).splitlines()[2:]
