#!/usr/bin/env python3
"""Wording: messages and help have no phrase that only a translation would have. With files as arguments, reads those."""

import pathlib
import re
import sys

import house

# Phrase -> what to write instead.
CALQUES = {
    r"but for": "except",
    r"anew": "again",
    r"stands? in(?= for\b|[;,.]|$)": "replaces, using",
    r"by (?:itself|themselves)": "on its own, automatically",
    r"go(?:es)? on": "continues",
    r"went on": "continued",
    r"that (?:is|are) there": "existing",
    r"what (?:is|was) there": "a noun",
    r"mend(?:s|ed|ing)?": "repair",
}
PATTERN = re.compile("|".join(rf"(?P<c{i}>\b{calque}(?!\w))" for i, calque in enumerate(CALQUES)), re.IGNORECASE | re.MULTILINE)

# The pages of experiments quote stored results; they are worded with those.
NOT_MESSAGES = ("lab/experiments/",)


def calques(text):
    """(offset, sentence) of every calque."""
    replacements = list(CALQUES.values())
    return [(m.start(), f"'{m[0]}' is a calque; write: {replacements[int(m.lastgroup[1:])]}") for m in PATTERN.finditer(text)]


def literals(text):
    """(offset, content) of string literals; neighbours are one, as the compiler joins them."""
    code = house.LITERAL_OR_COMMENT
    joined = []
    end = None
    for match in code.finditer(text):
        if match["comment"] is not None:
            continue
        if not match[0].startswith('"'):
            end = None
            continue
        if end is not None and not text[end:match.start()].strip():
            joined[-1] = (joined[-1][0], joined[-1][1] + match[0][1:-1])
        else:
            joined.append((match.start(), match[0][1:-1]))
        end = match.end()
    return joined


def check(root):
    problems = []
    for path in house.code_files(root):
        name = path.relative_to(root).as_posix()
        if not name.startswith(("src/", "lab/", "apps/")) or name.startswith(NOT_MESSAGES) or house.is_test_or_benchmark(path) or "/testing/" in name:
            continue
        text = path.read_text(encoding="utf-8")
        for offset, content in literals(text):
            line = text.count("\n", 0, offset) + 1
            problems += [f"{name}:{line}: {sentence}" for _, sentence in calques(content)]
    return problems


def check_texts(names):
    problems = []
    for name in names:
        text = pathlib.Path(name).read_text(encoding="utf-8")
        problems += [f"{name}:{text.count(chr(10), 0, offset) + 1}: {sentence}" for offset, sentence in calques(text)]
    return problems


if __name__ == "__main__":
    house.report(check_texts(sys.argv[1:]) if len(sys.argv) > 1 else check(house.ROOT))
