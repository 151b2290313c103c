"""check_launched_kernels.py NM LIBRARY OBJECT: checks that OBJECT, kernels.cu compiled for the host, instantiates every
kernel that LIBRARY launches. The build runs it, and stops if a list lacks a kernel."""
import sys

from kernel_names import compiled_kernels, launched_kernels, symbols_of


def main():
    nm, library, kernels = sys.argv[1:]
    launched = launched_kernels(symbols_of(nm, library))
    compiled = compiled_kernels(symbols_of(nm, kernels))
    if len(launched) < 40 or not compiled:
        sys.exit(f"{library} launches {len(launched)} kernels and {kernels} has {len(compiled)}: their symbols are missing")
    missing = sorted(launched - compiled)
    if missing:
        sys.exit("launched, but in no kernels.inc:\n  " + "\n  ".join(missing))
    print(f"all {len(launched)} launched kernels are compiled for the device")


main()
