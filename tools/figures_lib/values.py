"""Values of a table: paths into results, and the value of several repeats."""
import operator
import re
import statistics

from figures_lib.data import Problem

NUMBER = re.compile(r"-?\d[\d.]*(?:e[+-]?\d+)?")
# In the order of their precedence, the lowest first.
OPERATORS = ((" + ", operator.add), (" - ", operator.sub), (" * ", operator.mul), (" / ", operator.truediv))


def calculated(function, left, right):
    """Returns None if an operand is unknown, or for a quotient by zero."""
    if None in (left, right) or (function is operator.truediv and right == 0):
        return None
    return function(left, right)


def value_at(scope, path):
    """Returns the value at a path such as `mean.flip`, `settings.0.views`, `pair / reference` or `(a + b) * 1000`."""
    while "(" in path:
        path = re.sub(r"\(([^()]*)\)", lambda found: repr(value_at(scope, found[1])), path)
    for sign, function in OPERATORS:
        if sign in path:
            left, _, right = path.rpartition(sign)
            return calculated(function, value_at(scope, left), value_at(scope, right))
    if NUMBER.fullmatch(path):
        return float(path)
    if path == "None":
        return None
    for key in path.split("."):
        try:
            scope = scope[int(key) if isinstance(scope, list) else key]
        except (KeyError, IndexError, TypeError, ValueError) as error:
            raise Problem(f"no `{key}` of `{path}` in the result") from error
    return scope


def six_digits(value):
    """Returns a number with six digits; large integers keep all."""
    if isinstance(value, float) and value >= 1e6 and value.is_integer():
        return int(value)
    return float(f"{value:.6g}") if isinstance(value, float) else value


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def combined(values, has_spread):
    """Returns one value for several repeats: the median of numbers, or their range. Other values must be equal."""
    if all(value == values[0] for value in values):
        return six_digits(values[0])
    if not all(map(is_number, values)):
        raise Problem(f"repeats differ: {sorted(set(map(str, values)))}")
    return [six_digits(min(values)), six_digits(max(values))] if has_spread else six_digits(statistics.median(values))


def cell_of(column, scopes):
    """Returns the cell of a column from the results of all repeats."""
    cells = [combined([value_at(scope, path) for scope in scopes], column.get("spread", False))
             for path in column["from"]]
    return cells[0] if len(cells) == 1 else cells


def mapped_rows(table, scopes):
    """Returns a row, or a row per item of the list that `measured` names."""
    path = table["measured"].get("rows")
    if path is None:
        return [[cell_of(column, scopes) for column in table["columns"]]]
    lists = [value_at(scope, path) for scope in scopes]
    return [[cell_of(column, [{**scope, **items[i]} for scope, items in zip(scopes, lists)])
             for column in table["columns"]] for i in range(len(lists[0]))]
