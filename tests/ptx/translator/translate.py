#!/usr/bin/env python3
"""translate.py IN.ptx OUT.cpp [NAME]: translates PTX into C++ that does the same, with a ptx::Module called NAME
(ptx_module). An instruction, modifier or type that it does not know is an error: FILE:LINE: what."""

import pathlib
import sys

from emitter import translate
from errors import PtxError
from parser import parse


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    source, target = map(pathlib.Path, sys.argv[1:3])
    try:
        text = translate(parse(source.read_text(encoding="utf-8"), str(source)), sys.argv[3] if len(sys.argv) == 4 else "ptx_module")
    except (PtxError, OSError) as error:
        sys.exit(str(error))
    target.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
