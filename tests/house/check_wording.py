#!/usr/bin/env python3
"""Wording: string literals of C++, and comments and strings of scripts, have no phrase that only a translation would have.
check_prose.py reads pages and the comments of C++. With files as arguments, reads those."""

import pathlib
import re
import sys

import check_spelling
import house

# Phrase -> replacement. Patterns leave out legitimate uses.
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
    r"what there (?:is|was)": "a noun",
    r"what (?:is|are|was|were) left": "the rest, the remainder",
    r"what (?:comes?|came) out": "the result",
    r"what (?:it|they) (?:know|knows|knew)": "its samples, its state",
    r"as \w+ as ever": "as before",
    r"put(?:s|ting)? together": "combine",
    r"(?:right|true|agrees?|same|not) in the mean": "in expectation, unbiased",
    r"(?:finds?|finding|found) out": "determine, detect",
    r"(?:gives?|gave|giving) way": "yields to, is replaced by",
    r"ha(?:s|ve|d) no say": "does not affect",
    r"the way there": "the path to it",
    r"looks? away(?! from)": "does nothing",
    r"nobody(?:'s)?": "no caller, no pass, unused",
    r"whoever": "the caller, the code that",
    r"(?:(?<=[.:;|]\s)|(?<=\())who(?! (?:is|are|was)\b)": "the subject",
    r"(?:all|says|judges?|tells?|than) who": "those that",
    r"(?:samples?|paths?|rays|bytes|bits|times|ms|seconds|milliseconds|frames?) an? (?:pixel|frame|path|second|cell|texel)": "per",
    r"by a hair|a hair (?:wider|narrower|above|below|more|less)": "slightly",
    r"(?:each|all|both|counts?|treated|chosen|take) alike": "equally, the same way",
    r"in turns": "alternately",
    r"nothing (?:runs )?beside": "an otherwise idle machine",
    r"a right (?:image|value|result|answer|mean)": "correct",
    r"pictures?": "image",
    r"in the mean(?=,)": "on average",
    r"(?:is|are|was|were) (?:not |still |already |also )?there(?= (?:and|or|but|when|while|if|until|since|because|before|after)\b|[;,.:)\"'`]|$)":
        "exists, is missing, is installed",
    r"refus(?:ed|es) with an? (?:sentence|error)": "reports an error",
    r"(?:where|what|as|when)(?:ever)? (?:it|they) likes?": "the subject and its rule",
    r"(?:is|are|was|were|be) taken for(?! granted)": "is treated as",
    r"what ended under": "a noun",
    r"throw(?:s|n)? (?:it|them|light|samples?|paths?) away": "discards",
    r"stay(?:s|ed)? clear of": "avoids, is shortened to avoid",
    r"kn(?:ows?|ew) nothing of": "ignores",
    r"speaks? of": "names, refers to",
    # Things that think. The pattern covers common subjects only.
    r"(?:pass|kernel|light|lamp|path|subpath|pixel|texel|cell|region|cache|filter|denoiser|surface|image|frame)(?:e?s)? (?:knows?|knew|wants?|asks?|thinks?|believes?)":
        "the part that acts and what it does: reads, stores, requires",
}
# Phrases may be wrapped.
PATTERN = re.compile("|".join(rf"(?P<c{i}>\b(?:{calque})(?!\w))".replace(" ", r"\s+") for i, calque in enumerate(CALQUES)), re.IGNORECASE | re.MULTILINE)

# They quote the phrases.
QUOTES = ("tests/house/check_wording.py", "tests/house/house_test.py")


def calques(text):
    """(offset, sentence) of every calque."""
    replacements = list(CALQUES.values())
    return [(m.start(), f"'{' '.join(m[0].split())}' is a calque; write: {replacements[int(m.lastgroup[1:])]}") for m in PATTERN.finditer(text)]


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


def of_script(path):
    """Comments and strings of Python; the text of other scripts and lists of CMake; None of other files."""
    if path.suffix in house.CODE_SUFFIXES + (".md",):
        return None
    text = check_spelling.prose(path)
    if text is None and not path.suffix:
        content = path.read_bytes()
        text = content.decode("utf-8") if content.startswith(b"#!") else None
    return text


def check(root):
    code = set(house.code_files(root))
    problems = []
    for path in house.files(root):
        name = path.relative_to(root).as_posix()
        if name in QUOTES:
            continue
        if path in code:
            text = path.read_text(encoding="utf-8")
            for offset, content in literals(text):
                line = text.count("\n", 0, offset) + 1
                problems += [f"{name}:{line}: {sentence}" for _, sentence in calques(content)]
        elif (text := of_script(path)) is not None:
            problems += [f"{name}:{text.count(chr(10), 0, offset) + 1}: {sentence}" for offset, sentence in calques(text)]
    return problems


def check_texts(names):
    problems = []
    for name in names:
        text = pathlib.Path(name).read_text(encoding="utf-8")
        problems += [f"{name}:{text.count(chr(10), 0, offset) + 1}: {sentence}" for offset, sentence in calques(text)]
    return problems


if __name__ == "__main__":
    house.report(check_texts(sys.argv[1:]) if len(sys.argv) > 1 else check(house.ROOT))
