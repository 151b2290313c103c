#!/usr/bin/env python3
"""Prose of the docs: no calques, wrapped at 100 columns, sentences of at most 40 words with a median of at most 16. With
files as arguments, reads those and prints the median of each; with --comments, reads the comments of C++ for calques and
long sentences."""

import pathlib
import re
import statistics
import sys

import check_wording
import house
import prose

MAX_COLUMNS = 100
MAX_WORDS = 40
MAX_MEDIAN = 16

LISTED = re.compile(r"^ {2,}\S.*$", re.MULTILINE)  # indented lines of a comment: code or a list of names


def long_lines(name, text):
    """Table rows, links and code cannot be wrapped."""
    return [f"{name}:{n}: {len(line)} columns; wrap at {MAX_COLUMNS}" for n, line in enumerate(prose.without_code(text).split("\n"), 1)
            if len(line) > MAX_COLUMNS and not line.lstrip().startswith(("|", "[", "!", "<")) and " " in line.strip()]


def long_sentences(name, blocks):
    return [f"{name}:{n}: a sentence of {prose.words(s)} words; at most {MAX_WORDS}: {s[:60]}…" for n, text in blocks
            for s in prose.sentences(text) if prose.words(s) > MAX_WORDS]


def calques(name, text):
    body = prose.INLINE_CODE.sub(lambda m: " " * len(m[0]), prose.without_code(text))
    return [f"{name}:{body.count(chr(10), 0, offset) + 1}: {sentence}" for offset, sentence in check_wording.calques(body)]


def lengths(blocks):
    """Words of every sentence that ends like one: headings and cells are not sentences."""
    return [prose.words(s) for _, text in blocks for s in prose.sentences(text) if text.rstrip().endswith((".", ":", "!", "?")) and prose.words(s) > 2]


def check_page(name, text):
    """(problems, lengths of sentences) of a page."""
    blocks = prose.blocks(text)
    return long_lines(name, text) + long_sentences(name, blocks) + calques(name, text), lengths(blocks)


def check_comments(root):
    """Problems of the comments of C++, tests included."""
    problems = []
    for path in house.code_files(root):
        name = path.relative_to(root).as_posix()
        for line, text in house.comment_blocks(path.read_text(encoding="utf-8")):
            body = prose.INLINE_CODE.sub(lambda m: " " * len(m[0]), text)
            problems += [f"{name}:{line + body.count(chr(10), 0, offset)}: {sentence}" for offset, sentence in check_wording.calques(body)]
            problems += long_sentences(name, [(line, prose.without_markup(LISTED.sub("", text)))])
    return problems


def check(root, pages=None):
    """Problems of all pages, or of those named."""
    problems, all_lengths = [], []
    for page in pages or [p for p in house.files(root) if p.suffix == ".md"]:
        name = page.relative_to(root).as_posix() if page.is_relative_to(root) else str(page)
        found, counts = check_page(name, page.read_text(encoding="utf-8"))
        problems += found
        all_lengths += counts
        if pages and counts:
            print(f"{name}: median {statistics.median(counts)} words, {len(counts)} sentences")
    if all_lengths and statistics.median(all_lengths) > MAX_MEDIAN:
        problems.append(f"the median sentence has {statistics.median(all_lengths)} words; at most {MAX_MEDIAN}")
    return problems


if __name__ == "__main__":
    if sys.argv[1:] == ["--comments"]:
        house.report(check_comments(house.ROOT))
    house.report(check(house.ROOT, [pathlib.Path(p) for p in sys.argv[1:]]))
