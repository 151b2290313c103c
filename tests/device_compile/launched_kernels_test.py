"""launched_kernels_test.py NM LIBRARY OBJECT: checks that OBJECT, kernels.cu compiled for the host, instantiates every
kernel that LIBRARY launches."""
import re
import subprocess
import sys


def template_arguments(symbols, name):
    """First argument of each instantiation NAME<ARGUMENT>(...) among demangled symbols."""
    found = set()
    for match in re.finditer(rf"\b{name}<", symbols):
        depth = 1
        end = match.end()
        while depth > 0:
            depth += {"<": 1, ">": -1}.get(symbols[end], 0)
            end += 1
        found.add(symbols[match.end() : end - 1])
    return found


def symbols_of(nm, file):
    return subprocess.run([nm, "-C", file], check=True, capture_output=True, text=True).stdout


def main():
    nm, library, kernels = sys.argv[1:]
    launched = template_arguments(symbols_of(nm, library), "relume::launch")
    symbols = symbols_of(nm, kernels)
    compiled = template_arguments(symbols, "relume::device::run") | template_arguments(symbols, "relume::device::run_group")
    if len(launched) < 40 or not compiled:
        sys.exit(f"{library} launches {len(launched)} kernels and {kernels} has {len(compiled)}: their symbols are missing")
    missing = sorted(launched - compiled)
    if missing:
        sys.exit("launched, but in no kernels.inc:\n  " + "\n  ".join(missing))
    print(f"all {len(launched)} launched kernels are compiled for the device")


main()
