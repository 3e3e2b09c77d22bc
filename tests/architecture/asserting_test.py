#!/usr/bin/env python3
"""Checks that every test asserts something: a GoogleTest body has an expectation, a Python test a check or a raise.

A body may call a function of the same file that asserts; such calls are followed by name. A test that passes if it
ends (one of a fuzzer's seeds, for example) calls SUCCEED(). GTEST_SKIP() is reported as skipped, not as passed.

Usage: asserting_test.py SOURCE_DIR
"""
import ast
import re
import sys
from pathlib import Path

from verdict import verdict

TEST = re.compile(r"^(?:TEST|TEST_F|TEST_P|TYPED_TEST)\(\s*(\w+),\s*(\w+)\s*\)\s*\{", re.M)
FUNCTION = re.compile(r"^[\w:<>,&*\s\[\]]*?\b(\w+)\([^;{}]*\)\s*(?:const\s*)?(?:noexcept\s*)?\{", re.M)
ASSERTION = re.compile(r"\b(?:EXPECT_\w+|ASSERT_\w+|FAIL|ADD_FAILURE\w*|SUCCEED|GTEST_SKIP)\b")
CALL = re.compile(r"\b(\w+)\s*(?:<[\w:, ]*>)?\(")
CHECKS = re.compile(r"^(assert\w*|fail|succeed|refuse\w*|expect\w*|check\w*)$")


def body_at(text, brace):
    """Returns the text between the brace and its partner. Braces in strings and comments of tests must be balanced."""
    depth = 0
    for at in range(brace, len(text)):
        depth += {"{": 1, "}": -1}.get(text[at], 0)
        if depth == 0:
            return text[brace:at]
    return text[brace:]


def asserting(bodies):
    """Returns the names of the functions whose body asserts or calls an asserting function."""
    found = {name for name, body in bodies if ASSERTION.search(body)}
    while True:
        more = {name for name, body in bodies if name not in found and found & set(CALL.findall(body))}
        if not more:
            return found
        found |= more


def cpp_bodies(text):
    return [(match.group(1), body_at(text, match.end() - 1)) for match in FUNCTION.finditer(text)]


def silent_cpp(root):
    paths = sorted((root / "tests").rglob("*.cpp"))
    texts = {path: path.read_text() for path in paths}
    shared = [pair for path in sorted((root / "tests").rglob("*.h")) for pair in cpp_bodies(path.read_text())]
    for path in paths:
        if not path.name.endswith("_test.cpp"):
            shared += cpp_bodies(texts[path])
    for path in paths:
        tests = list(TEST.finditer(texts[path]))
        helpers = asserting(shared + cpp_bodies(texts[path])) - {"TEST", "TEST_F", "TEST_P"}
        for test in tests:
            body = body_at(texts[path], test.end() - 1)
            if not ASSERTION.search(body) and not helpers & set(CALL.findall(body)):
                yield f"{path.relative_to(root)}: {test.group(1)}.{test.group(2)} asserts nothing"


def called(node):
    """Returns the names of called functions, and whether a statement asserts or raises."""
    names, checks = set(), False
    for inner in ast.walk(node):
        if isinstance(inner, (ast.Assert, ast.Raise)):
            checks = True
        if isinstance(inner, ast.Call):
            function = inner.func
            names.add(function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", ""))
    return names, checks or any(CHECKS.match(name) for name in names)


def functions_of(path):
    return [node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.FunctionDef)]


def asserting_functions(functions, known):
    found = set(known)
    facts = [(f.name, *called(f)) for f in functions]
    while True:
        more = {name for name, names, checks in facts if name not in found and (checks or names & found)}
        if not more:
            return found
        found |= more


def silent_python(root):
    shared = [f for path in sorted((root / "tests").rglob("*.py")) if not path.name.endswith("_test.py")
              for f in functions_of(path)]
    known = asserting_functions(shared, ())
    for path in sorted((root / "tests").rglob("*_test.py")):
        functions = functions_of(path)
        found = asserting_functions(functions, known)
        for function in functions:
            if function.name.startswith("test_") and function.name not in found:
                yield f"{path.relative_to(root)}: {function.name} asserts nothing"
        if "verdict" not in path.read_text() and not found & {f.name for f in functions}:
            yield f"{path.relative_to(root)}: no function of it asserts anything"


def self_test():
    silent, loud = "TEST(A, B) {\n  run();\n}\n", "TEST(A, B) {\n  EXPECT_TRUE(x);\n}\n"
    for text, expected in ((silent, False), (loud, True)):
        match = TEST.search(text)
        assert bool(ASSERTION.search(body_at(text, match.end() - 1))) == expected, text
    assert called(ast.parse("def test_a():\n    run()"))[1] is False
    assert called(ast.parse("def test_a():\n    assert 1"))[1] is True


def main(root):
    self_test()
    return verdict([*silent_cpp(root), *silent_python(root)], "tests assert nothing")


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
