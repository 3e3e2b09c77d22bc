"""Rules for sentences and names, applied to the prose and the code of one file."""
import re
from typing import NamedTuple

FIRST_WORDS = set("Of What Where As Who Which Whether How So That From By Out With".split())
# Words that begin neither a verb phrase in the third person nor a noun phrase.
NO_CONTRACT = FIRST_WORDS | set("""
    For In On At To Into Onto Up Down Over Under Above Below Around Along Across Between Beyond Beside Before After
    Until While When If Since Because Though Nothing None Something Everything Those These This Its Their It They He
    She Is Are Was Were Does Do Did Must May Can Could Should Would Let Told Asked Said Called Thrown Here There Why
    Then Else Only Both Either Neither Such Not Nor And Or But Also Again Once Twice Without Within Through
    Against""".split())
# Comments describe functions; they do not command them.
IMPERATIVES = set("""
    Return Compute Get Set Write Read Check Make Create Add Remove Find Count Convert Copy Take Call Start Stop Wait
    Throw Open Close Send Receive Append Build Run Update Print Parse Decode Encode Load Store Test Visit Sort Sum
    Fill""".split())
MAX_SENTENCE_WORDS = 25
TAG = r"(?:Space|Exact|Range|Cost|Errors|Source)(?: \(\w+\))?"
TAG_LINE = re.compile(rf"{TAG}(?:\s{{2,}}|$)")
BURIED_TAG = re.compile(rf"\S\s+({TAG})(?:\s{{2,}}\S|$)")
SENTENCE_END = re.compile(r"(?<!e\.g)(?<!i\.e)(?<!vs)(?<!cf)(?<!et al)(?<!\b[A-Z])[.!?]\)?\s+(?=[A-Z(])")
DATE_OF_BUG = re.compile(r"\d{4}-\d\d-\d\d[:,]\s*")

PHRASES = [(re.compile(pattern, re.I), better) for pattern, better in (
    (r"\b(?:is|are|was|were|be|not|all|yet|already) here\b", "resident, not resident"),
    (r"\b(?:come|comes|came|coming) in\b", "is loaded, is received"),
    (r"\b(?:go|goes|went|going) on\b(?! to\b)", "continues"),
    (r"\blet(?:s)? (?:go|them go|it go)\b", "evicts, releases"),
    (r"\bwho (?!am\b)[a-z]+s?\b", "the caller, the user"),
    (r"\b(?:of those|those of)\b", "repeat the noun"),
    (r"\bas (?:it is|they are|it comes|they come|it was|they were)\b", "unchanged"),
    (r"\bof (?:its|their) own\b", "separate, own"),
    (r"\bso (?:many|few|much)\b", "N"),
    (r"\bheld against\b", "compared with"),
    (r"\b(?:take|takes|taken|taking|took) over\b", "reuse"),
    (r"\bin hand\b", "in flight"),
    (r"\bby turns\b", "alternately"),
    (r"\bonce more\b", "again"),
    (r"\bsigns? of life\b", "heartbeat"),
    (r"\bwritten out\b", "expanded"),
    (r"\bon (?:its|their) way\b", "in flight"),
)]
CLAUSES = re.compile(r"(?<![A-Za-z])what (?:is|are|was|were|it|they|he|of|has|have|can|lies|comes|follows)\b")
SUPERLATIVE = re.compile(
    r"(?:^|_)(most|least|longest|shortest|largest|smallest|widest|narrowest|farthest|fewest)(?:_|$)")
PLAIN_SUPERLATIVE = re.compile(
    r"(?:^|_)(?:at_(?:most|least)|(?:most|least)_significant|least_squares|least_recently_used)(?:_|$)")
IDENTIFIER = re.compile(r"[A-Za-z_]\w*")
MONTH = "January|February|March|April|May|June|July|August|September|October|November|December"
HISTORY = re.compile(
    rf"\b(?:20\d\d-\d\d-\d\d|(?:{MONTH}) 20\d\d|no longer|any ?more|formerly|previously|"
    r"used to (?:be|have|take|need|show)|until now|since version|(?:earlier|older) versions?)\b", re.I)


class Violation(NamedTuple):
    rule: str
    path: str
    line: int
    text: str
    weight: int = 1  # what the violation adds to the count of its rule


def sentences(block):
    """Yields pairs (line, sentence). A contract tag or the mark of a list item also begins a sentence."""
    parts = []
    for line in block.lines:
        tag = TAG_LINE.match(line[1])
        if not parts or tag or not line[1].strip() or re.match(r"\s*(?:[-*]|\d+\.) ", line[1]):
            parts.append([])
        parts[-1].append((line[0], line[1][tag.end():] if tag else line[1].lstrip("-* ")))
    for part in parts:
        text, line_at = block._replace(lines=part).joined()
        start = 0
        for end in [*(match.end() for match in SENTENCE_END.finditer(text)), len(text)]:
            if text[start:end].strip():
                yield line_at(start), text[start:end].strip()
            start = end


def first_word_problems(block):
    for line, sentence in sentences(block):
        word = re.match(r"\W*(\w+)", sentence)
        if word and word.group(1) in FIRST_WORDS:
            yield line, f"a sentence begins with {word.group(1)}"


def contract_problems(block):
    """The form of a `///` block; one that begins with a tag or the date of a bug has no summary to check."""
    for line, text in block.lines:
        tag = BURIED_TAG.search(text)
        if tag:
            yield "tags", line, f"{tag.group(1)} does not begin a line"
    line, text = next(sentences(block), (0, ""))
    if not text or TAG_LINE.match(block.lines[0][1]) or DATE_OF_BUG.match(text):
        return
    word = re.match(r"[\"'(]*([A-Za-z]*)(?![\w:.])", text)
    is_function = "(" in block.code and not re.match(r"(struct|class|enum|using|#)", block.code)
    if word and (word.group(1) in NO_CONTRACT or (is_function and word.group(1) in IMPERATIVES)):
        yield "contracts", line, f"begins with {word.group(1)}, not a verb in the third person, an article or a noun"
    count = len(re.findall(r"\S*\w\S*", text))
    if count > MAX_SENTENCE_WORDS:
        yield "summaries", line, f"the first sentence has {count} words, more than {MAX_SENTENCE_WORDS}"


def phrase_problems(block):
    text, line_at = block.joined()
    for pattern, better in PHRASES:
        for match in pattern.finditer(text):
            yield "phrases", line_at(match.start()), f"`{match.group()}`: {better}"
    for match in CLAUSES.finditer(text):
        yield "clauses", line_at(match.start()), f"`{match.group()}` stands for a noun: name it"


def snake_case(name):
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()


def name_problems(code):
    """Superlatives in identifiers, each identifier at its first use."""
    seen = set()
    for line, text in code:
        for name in IDENTIFIER.findall(text):
            if name in seen:
                continue
            seen.add(name)
            snake = snake_case(name)
            found = SUPERLATIVE.search(snake)
            if found and not PLAIN_SUPERLATIVE.search(snake):
                yield line, f"{name}: use max_ or min_, not {found.group(1)}"


def history_problems(block):
    text, line_at = block.joined()
    for match in HISTORY.finditer(text):
        yield line_at(match.start()), f"`{match.group()}`: dates and earlier states belong in docs/experiments"


def file_problems(path, source, tells_history):
    """Yields the violations of all rules for sentences and names in one file."""
    for block in source.blocks:
        if block.kind in ("contract", "comment"):
            yield from (Violation("first words", path, *found) for found in first_word_problems(block))
        if block.kind == "contract":
            yield from (Violation(rule, path, line, text) for rule, line, text in contract_problems(block))
        yield from (Violation(rule, path, line, text) for rule, line, text in phrase_problems(block))
        if block.kind == "page" and not tells_history:
            yield from (Violation("history", path, *found) for found in history_problems(block))
    yield from (Violation("names", path, *found) for found in name_problems(source.code))
