#!/usr/bin/env python3
"""translate.py IN.ptx OUT.cpp [NAME [PARTS]]: translates PTX into C++ that does the same, with a ptx::Module called NAME
(ptx_module). With PARTS, the functions are in as many files NAME_0.cpp and so on, and OUT.cpp must be NAME.cpp. An instruction,
modifier or type that the program does not know is an error: FILE:LINE: what."""

import pathlib
import sys

from emitter import translate, translate_parts
from errors import PtxError
from parser import parse


def main():
    if len(sys.argv) not in (3, 4, 5):
        sys.exit(__doc__)
    source, target = map(pathlib.Path, sys.argv[1:3])
    name = sys.argv[3] if len(sys.argv) > 3 else "ptx_module"
    try:
        module = parse(source.read_text(encoding="utf-8"), str(source))
        files = translate_parts(module, name, int(sys.argv[4])) if len(sys.argv) > 4 else {target.name: translate(module, name)}
    except (PtxError, OSError) as error:
        sys.exit(str(error))
    for file, text in files.items():
        (target.parent / file).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
