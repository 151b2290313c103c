"""Prose of pages and comments, without code, and its sentences."""

import re

FENCE = re.compile(r"^```.*?^```[ \t]*$", re.MULTILINE | re.DOTALL)
INDENTED_CODE = re.compile(r"^    .*$", re.MULTILINE)
INLINE_CODE = re.compile(r"`[^`\n]*`")
IMAGE = re.compile(r"!\[[^\]]*\]\([^)]*\)")
LINK = re.compile(r"(?<!\\)\[((?:[^\[\]]|\[[^\]]*\])*)\]\([^)]*\)")
CITATION = re.compile(r"\[[A-Z][^\]]*\d\d[^\]]*\]")
FORMULA = re.compile(r"\S+(?: (?:[=+·≈≤≥<>←×/−-]|∈) \S+)+")
SENTENCE_END = re.compile(r"(?<=[.!?:])[\"')\]]*\s+(?=[\"'(\[]?[A-Z0-9`§α-ωΑ-Ω-])|\n\s*\n|\s*;\s+")
ABBREVIATION = re.compile(r"\b(?:e\.g|i\.e|eq|fig|sec|ch|vs|approx|resp|al|cf|no)\.\s", re.IGNORECASE)
WORD = re.compile(r"[A-Za-zÀ-ž][\w'’-]*|\d[\d.,×%–-]*")


def without_code(markdown):
    """A page with its code blocks, fenced and indented, emptied; line numbers stay."""
    return INDENTED_CODE.sub("", FENCE.sub(lambda m: "\n" * m[0].count("\n"), markdown))


def without_markup(text):
    """A page's text: links keep their words, code and formulas become one word each."""
    text = IMAGE.sub("", text)
    text = LINK.sub(r"\1", text)
    text = INLINE_CODE.sub("Code", text)
    text = CITATION.sub("", text)
    return re.sub(r"[*_]{1,2}(\S[^*_\n]*?\S|\S)[*_]{1,2}", r"\1", text)


def blocks(markdown):
    """(line number, text) of every paragraph, list item, heading and line of a table cell of a page."""
    lines = without_code(markdown).split("\n")
    found = []
    start, current = 0, []

    def close():
        if current:
            found.append((start, without_markup(" ".join(current))))
            current.clear()

    for number, line in enumerate(lines, 1):
        stripped = line.strip()
        if stripped.startswith("|"):
            close()
            found += [(number, without_markup(part)) for part in re.split(r"\||<br>", stripped.strip("|")) if re.search("[A-Za-z]", part)]
        elif not stripped or stripped.startswith("#"):
            close()
            if stripped.startswith("#"):
                found.append((number, without_markup(stripped.lstrip("# "))))
        else:
            item = re.match(r"(?:[-*]|\d+\.)\s+", stripped)
            if item:
                close()
            if not current:
                start = number
            current.append(stripped[item.end():] if item else stripped)
    close()
    return found


def sentences(text):
    """The sentences of a block of text."""
    text = ABBREVIATION.sub(lambda m: m[0].replace(".", ""), FORMULA.sub("Formula", text))
    return [s for s in SENTENCE_END.split(text) if s and WORD.search(s)]


def words(sentence):
    return len(WORD.findall(sentence))
