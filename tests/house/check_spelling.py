#!/usr/bin/env python3
"""Spelling: the docs, and the comments and strings of sources, pass codespell, except for the words of spelling_ignored.txt."""

import io
import pathlib
import re
import shutil
import subprocess
import tempfile
import tokenize

import house

IGNORED = pathlib.Path(__file__).with_name("spelling_ignored.txt")
TEXT_SUFFIXES = (".md", ".txt", ".cmake", ".sh")
ESCAPE = re.compile(r"\\[nrt\"'0]|\\x[0-9a-fA-F]+")  # "\nmean" is no word


def ignored_words():
    """Lower-case words before the reasons."""
    lines = IGNORED.read_text(encoding="utf-8").splitlines()
    return [line.split()[0].lower() for line in lines if line.strip() and not line.startswith("#")]


def only(text, spans):
    """`text` with everything outside the spans (begin, end) blanked; line numbers stay."""
    result, at = [], 0
    for begin, end in spans:
        result.append("\n" * text.count("\n", at, begin))
        result.append(" " + text[begin:end] + " ")
        at = end
    return "".join(result)


def of_cpp(text):
    spans = [m.span() for m in house.LITERAL_OR_COMMENT.finditer(text) if not text.startswith("#include", text.rfind("\n", 0, m.start()) + 1)]
    return ESCAPE.sub(" ", only(text, spans))


def of_python(text):
    starts = [0]
    for line in text.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    spans = [(starts[t.start[0] - 1] + t.start[1], starts[t.end[0] - 1] + t.end[1]) for t in tokens if t.type in (tokenize.COMMENT, tokenize.STRING)]
    return ESCAPE.sub(" ", only(text, spans))


def prose(path):
    """Comments and strings of code, the whole text of docs, scripts and CMake lists; None for other files."""
    if path.suffix in house.CODE_SUFFIXES:
        return of_cpp(path.read_text(encoding="utf-8"))
    if path.suffix == ".py":
        return of_python(path.read_text(encoding="utf-8"))
    if path.suffix in TEXT_SUFFIXES or path.parent.name in ("scripts", "tools"):
        return path.read_text(encoding="utf-8")
    return None


def misspelt(texts):
    """Problems that codespell finds in texts by name, without those of ignored words."""
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        for name, text in texts.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_text(text, encoding="utf-8")
        command = ["codespell", "--quiet-level", "35", "--ignore-words-list", ",".join(ignored_words()) or ",", "."]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode not in (0, 64, 65):
        return [f"codespell failed: {done.stderr.strip()}"]
    return sorted(line.removeprefix("./") for line in done.stdout.splitlines() if "==>" in line)


def unused_words(texts):
    """Ignored words that no text has."""
    everything = "\n".join(texts.values()).lower()
    return [f"{IGNORED.name}: no text has '{word}' any more" for word in ignored_words() if not re.search(rf"\b{re.escape(word)}\b", everything)]


def check(root):
    own = {IGNORED.resolve()}
    texts = {path.relative_to(root).as_posix(): prose(path) for path in house.files(root) if path.resolve() not in own}
    texts = {name: text for name, text in texts.items() if text is not None}
    return misspelt(texts) + (unused_words(texts) if root == house.ROOT else [])


if __name__ == "__main__":
    if shutil.which("codespell") is None:
        print("no codespell")
        raise SystemExit(77)
    house.report(check(house.ROOT))
