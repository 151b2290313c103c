"""Names of kernels among the symbols of libraries and objects."""

import re
import subprocess


def template_arguments(symbols, name):
    """First argument of each instantiation NAME<ARGUMENT>(...) among demangled symbols."""
    found = set()
    for match in re.finditer(rf"\b{name}<", symbols):
        depth = 1
        end = match.end()
        while depth > 0:
            depth += {"<": 1, ">": -1}.get(symbols[end], 0)
            end += 1
        found.add(symbols[match.end() : end - 1].strip())
    return found


def symbols_of(nm, file):
    """The demangled symbols of a file."""
    return subprocess.run([nm, "-C", file], check=True, capture_output=True, text=True).stdout


def launched_kernels(symbols):
    """The kernels that a library launches, by its demangled symbols."""
    # launch() itself may be inlined everywhere, launch_on_device() never is.
    return template_arguments(symbols, "relume::launch_on_device")


def compiled_kernels(symbols):
    """The kernels that device code has entries for, among its demangled symbols."""
    return template_arguments(symbols, "relume::device::run") | template_arguments(symbols, "relume::device::run_group")
