"""Declarations of C++ files, found without a compiler: the words before a brace determine the scope that it opens.

Bodies of functions and the branches after an #else or #elif are ignored.
"""
import re
from typing import NamedTuple

NOISE = re.compile(r'''R"(?P<mark>[^\s()\\]{0,16})\(.*?\)(?P=mark)"      # raw strings
                   |"(?:\\.|[^"\\\n])*"                                  # strings
                   |(?<![0-9A-Fa-f])'(?:\\.|[^'\\\n])+'                  # characters; 1'000 is a number
                   |//[^\n]*|/\*.*?\*/''', re.S | re.X)
TOKEN = re.compile(r"[A-Za-z_]\w*|\d[\w.']*|::|->|\[\[|\]\]|[^\s]")
TYPE_WORDS = {"class", "struct", "union", "enum"}
MACRO_OF_ATTRIBUTES = re.compile(r"[A-Z][A-Z0-9_]+")


class Declaration(NamedTuple):
    kind: str    # "type", "alias", "variable" or "function"
    scope: tuple  # names of the enclosing namespaces and types; "" is an anonymous namespace
    name: str    # with template arguments, if it is a specialization
    line: int
    text: str    # definition of a type, or parameters of a function; without comments, names and default values

    @property
    def is_local_to_file(self):
        return "" in self.scope


def code_of(text):
    """Returns the lines without comments, contents of strings, preprocessor lines and the branches after an #else."""
    def blank(match):
        found = match.group()
        return ('""' if found[0] in 'R"' else "0" if found[0] == "'" else " ") + "\n" * found.count("\n")
    lines, skipping, continued = [], [], False
    for line in NOISE.sub(blank, text).split("\n"):
        directive = re.match(r"\s*#\s*(\w+)", line)
        word = directive.group(1) if directive else ""
        if word in ("if", "ifdef", "ifndef"):
            skipping.append(False)
        elif word in ("else", "elif") and skipping:
            skipping[-1] = True
        elif word == "endif" and skipping:
            skipping.pop()
        lines.append("" if directive or continued or any(skipping) else line)
        continued = (bool(directive) or continued) and line.endswith("\\")
    return "\n".join(lines)


def tokens_of(code):
    """Yields pairs (token, line)."""
    for number, line in enumerate(code.split("\n"), 1):
        for match in TOKEN.finditer(line):
            yield match.group(), number


def end_of_braces(tokens, at):
    """Returns the index after the partner of the brace at `at`."""
    depth = 0
    while at < len(tokens):
        depth += {"{": 1, "}": -1}.get(tokens[at][0], 0)
        at += 1
        if depth == 0:
            break
    return at


def without_heads(words):
    """Returns the words without access labels, attributes and any number of `template <...>`."""
    words = list(words)
    while len(words) > 1 and words[0] in ("public", "private", "protected") and words[1] == ":":
        words = words[2:]
    while words and words[0] == "template":
        depth, end = 0, 1
        while end < len(words):
            depth += {"<": 1, ">": -1}.get(words[end], 0)
            end += 1
            if depth == 0:
                break
        words = words[end:]
    while "[[" in words and "]]" in words:
        words = words[:words.index("[[")] + words[words.index("]]") + 1:]
    return words


def outer_place(words, wanted):
    """Returns the index of the first of `wanted` outside parentheses and template arguments; None if there is none."""
    depth = 0
    for place, word in enumerate(words):
        if depth == 0 and word in wanted and not (word == "<" and place == 0):
            return place
        if word in "([" or (word == "<" and place > 0 and re.match(r"\w", words[place - 1])):
            depth += 1
        elif word in ")]" or (word == ">" and depth > 0 and "<" in words[:place]):
            depth -= 1
    return None


def type_name(words):
    """Returns the name of a type, such as A::B<int> for `class A::B<int> final : Base`."""
    end = next((i for i, word in enumerate(words) if word == ":" or word == "final"), len(words))
    words = [w for w in words[1:end] if w not in TYPE_WORDS and not MACRO_OF_ATTRIBUTES.fullmatch(w)] or words[1:end]
    if words[:1] == ["alignas"]:
        words = words[words.index(")") + 1:]
    return "".join(words)


def parameters(words):
    """Returns the types of a parameter list without names and default values, and a `const` that follows the list."""
    depth, end = 0, 0
    for end, word in enumerate(words):
        depth += {"(": 1, ")": -1}.get(word, 0)
        if depth == 0:
            break
    types, current, nested = [], [], 0
    for word in words[1:end] + [","]:
        nested += {"(": 1, "<": 1, "[": 1, "{": 1, ")": -1, ">": -1, "]": -1, "}": -1}.get(word, 0)
        if word != "," or nested > 0:
            current.append(word)
            continue
        current = current[:current.index("=")] if "=" in current else current
        if len(current) > 1 and re.match(r"[A-Za-z_]", current[-1]) and current[-2] not in ("::", "const"):
            current = current[:-1]
        types.append(" ".join(current))
        current = []
    return f"({', '.join(types)})" + (" const" if "const" in words[end:] else "")


def more_names(words):
    """Yields the names after commas, such as `b` and `c` in `= 1, b = 2, c`."""
    depth = 0
    for place, word in enumerate(words[:-1]):
        depth += {"(": 1, "<": 1, "[": 1, "{": 1, ")": -1, ">": -1, "]": -1, "}": -1}.get(word, 0)
        if word == "," and depth <= 0 and re.match(r"[A-Za-z_]", words[place + 1]):
            yield words[place + 1]


def declared(words, scope, line):
    """Yields the named declarations of a statement, except for types."""
    words = without_heads(words)
    if not words or words[0] in TYPE_WORDS | {"friend", "extern", "static_assert", "public", "private", "protected"}:
        return
    if words[0] in ("using", "typedef", "namespace"):
        if words[0] == "using" and len(words) > 3 and words[2] == "=":
            yield Declaration("alias", scope, words[1], line, " ".join(words[3:]))
        return
    stop = outer_place(words, {"(", "=", "{", "["})
    stop = len(words) if stop is None else stop
    name = next((w for w in reversed(words[:stop]) if re.match(r"[A-Za-z_]", w)), None)
    if name is None or stop < 2 or "operator" in words[:stop] or "::" in words[stop - 2:stop] \
            or words[stop - 1] == ">":  # a member of a type, an operator, or a specialization
        return
    if stop < len(words) and words[stop] == "(":
        yield Declaration("function", scope, name, line, parameters(words[stop:]))
        return
    for variable in [name, *more_names(words[stop:])]:
        yield Declaration("variable", scope, variable, line, "")


def opened_scope(words):
    """Returns the scope that the words before a brace open: "namespace", "type" or None, and its names."""
    words = without_heads(words)
    while words and words[0] in ("inline", "typedef", "static", "constexpr", "const"):
        words = words[1:]
    if words[:1] == ["namespace"]:
        return "namespace", tuple(w for w in words[1:] if w not in ("::", "inline")) or ("",)
    if words and words[0] in TYPE_WORDS and "=" not in words and "(" not in [w for w in words if w != "alignas"][:2]:
        name = type_name(words)
        has_call = re.search(r"\w \( ", " ".join(words).replace("alignas ( ", ""))
        return ("type", (name,)) if not has_call else (None, ())
    return None, ()


def declarations(text):
    """Returns the types that a file defines, and the functions, variables and aliases at namespace scope."""
    tokens, found, scopes = list(tokens_of(code_of(text))), [], []
    start = at = 0
    while at < len(tokens):
        token = tokens[at][0]
        words = [t for t, _ in tokens[start:at]]
        line = tokens[start][1]
        scope = tuple(name for kind, names in scopes for name in names)
        in_namespace = all(kind == "namespace" for kind, _ in scopes)
        if token == "{":
            kind, names = opened_scope(words)
            if kind is None:  # the body of a function, or the value of a variable: the statement continues after it
                end = end_of_braces(tokens, at)
                if end < len(tokens) and tokens[end][0] in (";", ",", "(", ")", ">", "{"):
                    at = end
                    continue
                found += declared(words, scope, line) if in_namespace else []
                at = start = end
                continue
            if kind == "type" and names != ("",):
                end = end_of_braces(tokens, at)
                found.append(Declaration("type", scope, names[0], line, " ".join(t for t, _ in tokens[start:end])))
            scopes.append((kind, names))
            at = start = at + 1
        elif token == "}":
            if scopes:
                scopes.pop()
            at = start = at + 1
        elif token == ";":
            found += declared(words, scope, line) if in_namespace else []
            at = start = at + 1
        else:
            at += 1
    return found
