"""Splits PTX into tokens."""

import re
from typing import NamedTuple

from errors import PtxError


class Token(NamedTuple):
    kind: str  # "word", "number", "float", "string", "punctuation" or "end"
    text: str
    line: int


TOKEN = re.compile(
    r"""(?P<space>[ \t\r\f]+|//[^\n]*)
      | (?P<newline>\n)
      | (?P<comment>/\*.*?\*/)
      | (?P<float>0[fF][0-9a-fA-F]{8}\b|0[dD][0-9a-fA-F]{16}\b)
      | (?P<number>(?:0[xX][0-9a-fA-F]+|[0-9]+)U?\b)
      | (?P<word>[A-Za-z_$%.](?:[\w$.]|::)*)
      | (?P<string>"[^"\n]*")
      | (?P<punctuation>[{}()\[\],;:@!=<>+|-])""",
    re.VERBOSE | re.DOTALL,
)


def tokens(text, file):
    """The tokens of `text`, with an "end" at the end. Raises PtxError."""
    found = []
    line = 1
    position = 0
    for match in TOKEN.finditer(text):
        if match.start() > position:
            break
        kind = match.lastgroup
        if kind == "newline":
            line += 1
        elif kind == "comment":
            line += match[0].count("\n")
        elif kind != "space":
            found.append(Token(kind, match[0], line))
        position = match.end()
    if position < len(text):
        raise PtxError(file, line, f"unexpected character {text[position]!r}")
    found.append(Token("end", "the end of the file", line))
    return found
