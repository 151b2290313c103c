"""Shared by the house checks: the files of the repository, and C++ text without comments and strings."""

import functools
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
CODE_FOLDERS = ("include", "src", "lab", "apps", "python", "tests", "bench", "tools")
CODE_SUFFIXES = (".h", ".cpp", ".cu")

LITERAL_OR_COMMENT = re.compile(
    r"""(?P<comment>//(?:\\\n|[^\n])*|/\*.*?\*/)
      | R"(?P<tag>[^\s()\\]*)\(.*?\)(?P=tag)"
      | "(?:\\.|[^"\\\n])*"
      | (?<![0-9A-Za-z_])'(?:\\.|[^'\\\n])+'""",
    re.VERBOSE | re.DOTALL,
)


def top_level(root):
    """Top-level files and folders, without build folders and outputs. In a checkout, only those that git tracks: running the program may leave others."""
    present = sorted(p for p in root.iterdir() if not p.name.startswith((".", "build")) and p.name != "out")
    if not (root / ".git").exists():
        return present
    tracked = subprocess.run(["git", "ls-files", "-z"], cwd=root, capture_output=True, text=True, check=False).stdout
    names = {name.split("/")[0] for name in tracked.split("\0")}
    return [p for p in present if p.name in names] if tracked else present


def files(root):
    """All files of the repository, sorted, without build folders, outputs and names that begin with a dot."""
    found = []
    for path in top_level(root):
        found += sorted(p for p in path.rglob("*") if p.is_file() and "__pycache__" not in p.parts) if path.is_dir() else [path]
    return found


def code_files(root):
    """C++ and CUDA sources."""
    return [p for p in files(root) if p.suffix in CODE_SUFFIXES and p.relative_to(root).parts[0] in CODE_FOLDERS]


@functools.lru_cache(maxsize=4)  # several checks of the same file
def without_comments(text, keep_strings=False):
    """`text` with comments blanked and, unless kept, literals emptied; line numbers stay."""

    def blank(match):
        if match["comment"] is None and keep_strings:
            return match[0]
        return ('""' if match["comment"] is None else " ") + "\n" * match[0].count("\n")

    return LITERAL_OR_COMMENT.sub(blank, text)


def comments(text):
    """(line number, text) of every comment."""
    return [(text.count("\n", 0, m.start()) + 1, m["comment"]) for m in LITERAL_OR_COMMENT.finditer(text) if m["comment"]]


def comment_blocks(text):
    """(line number, text) of every comment, without slashes; comments on neighbouring lines are one."""
    blocks = []
    end = None
    for match in LITERAL_OR_COMMENT.finditer(text):
        if match["comment"] is None:
            continue
        words = re.sub(r"^//+<?|^/\*+|\*/$", "", match["comment"])
        if end is not None and re.fullmatch(r"[ \t]*\n[ \t]*", text[end:match.start()]):
            blocks[-1] = (blocks[-1][0], f"{blocks[-1][1]}\n{words}")
        else:
            blocks.append((text.count("\n", 0, match.start()) + 1, words))
        end = match.end()
    return blocks


def is_test_or_benchmark(path):
    return path.stem.endswith(("_test", "_bench"))


def report(problems):
    """Prints one problem per line and exits: with 1 if there are any, else with 0."""
    for problem in problems:
        print(problem)
    sys.exit(1 if problems else 0)
