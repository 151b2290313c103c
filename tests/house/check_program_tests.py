#!/usr/bin/env python3
"""Tests of the program: ctest runs each method of tests/program/*_test.py exactly once. tests/program/CMakeLists.txt splits long scripts by hand."""

import ast
import collections
import re

import house

FOLDER = "tests/program"
LISTS = f"{FOLDER}/CMakeLists.txt"

# Commands that run a script; groups: the script without "_test.py", and the tests, a class or CLASS.METHOD.
COMMANDS = (
    re.compile(r"relume_add_program_test\((?P<script>\w+)(?P<tests>)"),
    re.compile(r"relume_add_program_part\(\S+\s+(?P<script>\w+)\s+(?P<tests>[\w.]+)"),
    re.compile(r"COMMAND\s+Python3::Interpreter\s+\$\{CMAKE_CURRENT_SOURCE_DIR\}/(?P<script>\w+)_test\.py\s*(?P<tests>[\w.]*)"),
)
LOOP = re.compile(r"foreach\((\w+) ([^)]*)\)(.*?)endforeach\(\)", re.DOTALL)
FUNCTION = re.compile(r"function\(.*?endfunction\(\)", re.DOTALL)
DEFAULT = re.compile(r'defaultTest=sys\.argv\[1:\] or "(\w+)"')


def commands(text):
    """(script, tests) of each command; no tests: the script's default."""
    text = FUNCTION.sub("", re.sub(r"#[^\n]*", "", text))
    text = LOOP.sub(lambda loop: "".join(loop[3].replace(f"${{{loop[1]}}}", item) for item in loop[2].split()), text)
    return [(match["script"], match["tests"]) for command in COMMANDS for match in command.finditer(text)]


def methods(source):
    """Names CLASS.METHOD of all tests of a script, with those that a class inherits within the script."""
    classes = {node.name: node for node in ast.parse(source).body if isinstance(node, ast.ClassDef)}

    def tests_of(name):
        if name not in classes:
            return set()
        own = {f.name for f in classes[name].body if isinstance(f, ast.FunctionDef) and f.name.startswith("test")}
        return own.union(*(tests_of(base.id) for base in classes[name].bases if isinstance(base, ast.Name)))

    return sorted(f"{name}.{test}" for name in classes for test in tests_of(name))


def check(root):
    problems = []
    runs = collections.defaultdict(list)
    for script, tests in commands((root / LISTS).read_text(encoding="utf-8")):
        runs[script].append(tests)
    for path in sorted((root / FOLDER).glob("*_test.py")):
        name = path.relative_to(root).as_posix()
        source = path.read_text(encoding="utf-8")
        default = DEFAULT.search(source)
        selections = [tests or (default[1] if default else "") for tests in runs[path.stem.removesuffix("_test")]]
        all_methods = methods(source)
        for selection in selections:
            if selection and not any(f"{method}.".startswith(f"{selection}.") for method in all_methods):
                problems.append(f"{LISTS}: {name} has no test {selection}")
        for method in all_methods:
            count = sum(not selection or f"{method}.".startswith(f"{selection}.") for selection in selections)
            if count != 1:
                problems.append(f"{name}: ctest runs {method} {count} times; list it once in {LISTS}")
    return problems


if __name__ == "__main__":
    house.report(check(house.ROOT))
