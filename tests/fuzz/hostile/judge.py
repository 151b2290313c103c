"""Checks a finished run for problems."""

import fnmatch
import json
import os
import pathlib
import re
import stat

# Internal words of libraries and C++, which no message may contain.
INTERNAL = [b"terminate called", b"std::", b"ssertion", b"basic_string", b"bad_alloc", b"json.exception", b"vector::", b"map::at", b"stoi", b"stof", b"what()",
            b"filesystem error", b"Sanitizer", b"runtime error:", b"Traceback", b"CLI::", b"Segmentation"]
CONTROL = re.compile(rb"[\x00-\x08\x0b-\x1f\x7f]")


def snapshot(folder):
    """State of each path below `folder`, to detect changes. Links count as themselves."""
    found = {}
    for root, folders, files in os.walk(folder):
        for name in files + [f for f in folders if os.path.islink(os.path.join(root, f))]:
            path = os.path.join(root, name)
            state = os.lstat(path)
            if stat.S_ISREG(state.st_mode):
                found[os.path.relpath(path, folder)] = pathlib.Path(path).read_bytes()
            else:
                found[os.path.relpath(path, folder)] = os.readlink(path) if stat.S_ISLNK(state.st_mode) else ""
    return found


def is_allowed(name, patterns):
    return any(fnmatch.fnmatchcase(name, pattern) for pattern in patterns)


def judge_files(case, succeeded, before, after):
    problems = []
    changed = [name for name in after if before.get(name) != after[name]]
    problems += [f"deleted {name!r}" for name in before if name not in after]
    for name in changed:
        if ".tmp" in os.path.basename(name):
            problems.append(f"left the temporary file {name!r}")
        elif name.startswith("cache/"):
            continue
        elif not succeeded and not is_allowed(name, case.may_stay):
            problems.append(f"failed, but {'changed' if name in before else 'left'} {name!r}")
        elif succeeded and name in case.files and name not in case.may_change:
            problems.append(f"replaced the input {name!r}")
        elif succeeded and not name.startswith("made/") and not is_allowed(name, case.may_change):
            problems.append(f"wrote {name!r}, which is not a declared output")
        elif after[name] == b"":
            problems.append(f"wrote nothing into {name!r}")
    if succeeded:
        problems += [f"succeeded without {name!r}" for name in case.required if not after.get(name)]
    return problems


def refuse_constant(name):
    raise ValueError(f"{name} is not JSON")


def judge_texts(case, run):
    problems = []
    texts = run.stdout + run.stderr
    problems += [f"prints {word.decode()!r}" for word in INTERNAL if word in texts and not any(word in data for data in case.files.values())]
    if match := CONTROL.search(run.stderr):
        problems.append(f"prints the control character {match[0]!r} on standard error")
    if case.arguments[:1] == ["info"] and (match := CONTROL.search(run.stdout)):
        problems.append(f"prints the control character {match[0]!r}")
    lines = run.stderr.rstrip(b"\n").split(b"\n") if run.stderr else []
    errors = [line for line in lines if line.startswith(b"relume: ")]
    if run.exit_code == 0:
        problems += ["reports an error and succeeds"] if errors else []
        if "--json" in case.arguments and "--markdown" not in case.arguments and not case.stdout and run.stdout.startswith(b"{"):
            try:
                json.loads(run.stdout.decode(), parse_constant=refuse_constant)
            except ValueError as error:
                problems.append(f"prints JSON that is none: {error}")
    elif len(errors) != 1 or lines[-1] != errors[0] or len(errors[0]) <= len(b"relume: "):
        if case.arguments:  # without arguments, the program prints its help
            problems.append("fails without one line that says why")
    if "-q" in case.arguments:
        problems += [f"prints a line that is neither a warning nor an error: {line[:80]!r}" for line in lines if not line.startswith((b"relume: ", b"warning: "))][:1]
    return problems


def judge(case, run, before, after):
    """Problems as sentences; empty on success."""
    if run.hung:
        return [f"hangs: ended after {run.seconds:.0f} s"]
    problems = [f"needs {run.memory >> 20} MiB"] if run.too_large else []
    if run.exit_code < 0 and not run.too_large:
        problems.append(f"ends by signal {-run.exit_code}")
    elif run.exit_code not in (0, 1, 2) and not run.too_large:
        problems.append(f"ends with exit code {run.exit_code}")
    if case.refused and run.exit_code == 0:
        problems.append("accepts arguments that it must refuse")
    if run.left_behind:
        problems.append("leaves a process behind")
    if not run.too_large and run.exit_code >= 0:
        problems += judge_texts(case, run)
    return problems + judge_files(case, run.exit_code == 0, before, after)
