#!/usr/bin/env python3
"""exported_symbols_test.py NM LIBRARY: checks that the shared library exports only symbols of the public headers."""

import pathlib
import re
import subprocess
import sys

HEADERS = pathlib.Path(__file__).resolve().parents[2] / "include/relume"


def exported(nm, library):
    lines = subprocess.run([nm, "-D", "-C", "--defined-only", library], check=True, capture_output=True, text=True).stdout.splitlines()
    return [line.split(maxsplit=2)[2] for line in lines]


def main():
    symbols = exported(*sys.argv[1:])
    text = "".join(path.read_text() for path in HEADERS.glob("*.h"))
    names = set(re.findall(r"RELUME_API[^;{]*?\b(\w+)\s*(?:\(|:(?!:)|\{)", text))
    wrong = []
    for symbol in symbols:
        match = re.search(r"^(?:typeinfo for |typeinfo name for |vtable for )?relume::(\w+)", symbol)
        if not match or match[1] not in names:
            wrong.append(symbol)
    for needed in ("Session", "Settings", "load_scene", "version"):
        if not any(f"relume::{needed}" in symbol for symbol in symbols):
            wrong.append(f"{needed} is missing")
    print(f"{len(symbols)} symbols, of {len(names)} public names")
    if wrong:
        sys.exit("not of the public interface:\n" + "\n".join(wrong[:40]))


if __name__ == "__main__":
    main()
