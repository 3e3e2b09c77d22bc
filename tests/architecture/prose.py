"""Prose of the repository: comments, messages and documents, with the line of each piece of text.

Names are not prose: text in backticks, file names, calls, code blocks of documents, and literals of fewer than three
words are left out.
"""
import re
from bisect import bisect_right
from typing import NamedTuple

CPP = {".h", ".cpp", ".cu", ".cuh", ".js"}
CPP_NOISE = re.compile(r'''(?P<text>R"(?P<mark>[^\s()\\]{0,16})\(.*?\)(?P=mark)"  # raw strings
                       |"(?:\\.|[^"\\\n])*")                                     # strings
                       |(?<![0-9A-Fa-f])'(?:\\.|[^'\\\n])+'                      # characters; 1'000 is a number
                       |(?P<comment>//[^\n]*|/\*.*?\*/)''', re.S | re.X)
PYTHON_NOISE = re.compile(r"""(?P<text>(?:\"{3}.*?\"{3}|'{3}.*?'{3}|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'))
                          |(?P<comment>\#[^\n]*)""", re.S | re.X)
CMAKE_NOISE = re.compile(r'(?P<text>"(?:\\.|[^"\\])*")|(?P<comment>#[^\n]*)', re.S)
SCRIPT_NOISE = re.compile(r"""(?P<text>"(?:\\.|[^"\\])*"|'[^'\n]*')|(?<!\S)(?P<comment>\#(?!!)[^\n]*)""", re.S)
MARGIN = re.compile(r"^\s*(?:///<?|//|/\*+|#+|\*/|\*(?= ))?\s?|\s*\*/\s*$")
FIELD = re.compile(r"\{[^{}\n]*\}")
QUOTED = re.compile(r"`[^`\n]*`|\bhttps?://[^\s)]+|\b\w+\([^()\n]*\)|"
                    r"\btools/[\w-]+|\b[\w./-]+\.(?:h|cpp|cuh?|py|md|json|cmake|txt|cache|xml|sh|js|html)\b")
LINK = re.compile(r"\]\([^)\n]*\)|<[^>\n]*>")
WORDS = re.compile(r"\b[A-Za-z][a-z']*[,;:]? +[A-Za-z][a-z']*[,;:]? +[A-Za-z]")


class Block(NamedTuple):
    """Consecutive lines of one piece of prose."""
    kind: str    # "contract" (of ///), "comment", "message" or "page"
    lines: list  # pairs (line number, text without comment marks)
    code: str    # the line of code that follows the block

    def joined(self):
        """Returns the text in one line, and a function from an offset in that text to a line number."""
        starts, text = [], ""
        for _, line in self.lines:
            starts.append(len(text))
            text += line.strip() + " "
        return text.rstrip(), lambda offset: self.lines[bisect_right(starts, offset) - 1][0]


class Source(NamedTuple):
    """The prose of a file, and its code without comments and literals."""
    blocks: list
    code: list  # pairs (line number, code)


def unnamed(text):
    """Replaces names by NAME, so that their words are not checked."""
    return QUOTED.sub("NAME", text)


def grouped(comments, lines):
    """Joins full-line comments of the same mark on consecutive lines. comments: triples (line, column, text)."""
    blocks, last_line = [], 0
    for number, column, text in comments:
        is_full_line = not lines[number - 1][:column].strip()
        kind = "contract" if text.startswith("///") and is_full_line else "comment"
        stripped = [(number + i, unnamed(MARGIN.sub("", line))) for i, line in enumerate(text.split("\n"))]
        if blocks and is_full_line and number == last_line + 1 and blocks[-1].kind == kind:
            blocks[-1].lines.extend(stripped)
        else:
            blocks.append(Block(kind, stripped, ""))
        last_line = number + text.count("\n") if is_full_line else 0
    for block in blocks:
        following = block.lines[-1][0]
        yield block._replace(code=lines[following].strip() if following < len(lines) else "")


def literal_lines(number, literal):
    """Returns the lines of a string literal without its quotes; line ends become spaces, format fields are removed."""
    body = re.sub(r'^R?("""|\'\'\'|["\'])|("""|\'\'\'|["\'])$', "", literal)
    body = FIELD.sub("NAME", body.replace("\\n", "  ").replace('\\"', '"'))
    return [(number + i, unnamed(line)) for i, line in enumerate(body.split("\n"))]


def scanned(text, noise):
    """Returns the prose and the code of a file whose comments and literals match `noise`."""
    lines = text.split("\n")
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line) + 1)
    comments, docstrings, messages, code, end, last_literal = [], [], [], [], 0, -1
    for match in noise.finditer(text):
        number = bisect_right(starts, match.start())
        between = text[end:match.start()]
        code.extend((bisect_right(starts, end) + i, piece) for i, piece in enumerate(between.split("\n")))
        end = match.end()
        if match.group("comment"):
            comments.append((number, match.start() - starts[number - 1], match.group("comment")))
        elif match.group("text"):
            found = literal_lines(number, match.group("text"))
            if match.group("text").startswith('"""'):
                docstrings.append(Block("comment", found, ""))
            elif last_literal >= 0 and re.fullmatch(r"\s*[fr]?", text[last_literal:match.start()]):
                messages[-1].extend(found)
            else:
                messages.append(found)
            last_literal = match.end()
    code.extend((bisect_right(starts, end) + i, piece) for i, piece in enumerate(text[end:].split("\n")))
    blocks = [*grouped(comments, lines), *docstrings, *(Block("message", found, "") for found in messages)]
    return Source([b for b in blocks if b.kind != "message" or WORDS.search(b.joined()[0])], code)


def page(text):
    """Returns the paragraphs, list items, headings and table rows of a document."""
    blocks, fenced, fresh = [], False, True
    for number, line in enumerate(text.split("\n"), 1):
        if line.lstrip().startswith("```"):
            fenced, fresh = not fenced, True
        elif fenced or not line.strip():
            fresh = True
        else:
            fresh = fresh or bool(re.match(r"\s*(?:[-*|#]|\d+\.) ?", line))
            stripped = (number, LINK.sub("]", unnamed(line)).lstrip("#-*| "))
            if fresh:
                blocks.append(Block("page", [], ""))
            blocks[-1].lines.append(stripped)
            fresh = False
    return Source(blocks, [])


def source(path, text):
    """Returns the prose of a file by its name; None if the file has no prose that is checked."""
    if path.suffix in CPP:
        return scanned(text, CPP_NOISE)
    if path.suffix == ".py":
        return scanned(text, PYTHON_NOISE)
    if path.suffix in (".md", ".html"):
        return page(text)
    if path.suffix == ".cmake" or path.name == "CMakeLists.txt":
        return scanned(text, CMAKE_NOISE)
    if path.suffix in (".sh", ".sbatch", ".yml", ".yaml", ".in") or path.name.startswith(".clang") or not path.suffix:
        return scanned(text, SCRIPT_NOISE)
    return None
