#!/usr/bin/env python3
"""Writes the ctest entries of a GoogleTest program: an entry for all quick tests of a suite, and one for each slow test.

Starting a process takes longer than most tests, so those of a suite share one. A suite of many tests has several
entries, which ctest runs in parallel. With RELUME_SINGLE_TESTS in the environment, ctest runs each test on its own.
"""

import argparse
import fnmatch
import math
import subprocess
import sys

LISTING_SECONDS = 60
SECONDS_SHARE = 60  # each further test of an entry adds this fraction of the time limit of one test

# All tests of the entry were skipped, and none failed: the list of skipped tests ends the output.
SKIPPED = "\\[  PASSED  \\] 0 tests\\.\n(\\[  SKIPPED \\][^\n]*\n)+$"
# Without this, a program whose tests have other names passes.
NO_TESTS = "Running 0 tests"

# Options whose values CMake separates by semicolons.
LISTS = {
    "slow": "patterns of slow tests, SUITE.TEST",
    "omit": "patterns of tests without an entry, SUITE.TEST",
    "alone": "patterns of suites whose tests need a process each",
    "emulator": "command that runs programs of another architecture",
    "properties": "of all entries: NAME;VALUE;...",
}


def split(text):
    return text.split(";") if text else []


def parse_listing(text):
    """Suites in order, each with the names of its tests, from the output of --gtest_list_tests."""
    suites = {}
    suite = None
    for line in text.splitlines():
        name = line.split("#")[0].strip()
        if line.startswith("  "):
            suites[suite].append(name)
        elif name.endswith("."):
            suite = name[:-1]
            suites.setdefault(suite, [])
    return suites


def matches(name, patterns):
    return any(fnmatch.fnmatchcase(name, pattern) for pattern in patterns)


def parts_of(tests, most):
    """Tests in parts of about `most`. Tests of one parameter stay together, because they can share what they compute."""
    count = math.ceil(len(tests) / most)
    numbers = {}
    parts = [[] for _ in range(count)]
    for test in tests:
        key = test.rpartition("/")[2]
        parts[numbers.setdefault(key, len(numbers)) % count].append(test)
    return [part for part in parts if part]


def quoted(text):
    return f"[==[{text}]==]"


class Writer:
    def __init__(self, options):
        self.options = options

    def entry(self, name, tests, properties):
        command = [*self.options.emulator, self.options.program, f"--gtest_filter={':'.join(tests)}"]
        name = quoted(self.options.prefix + name)
        everywhere = {"WORKING_DIRECTORY": self.options.directory, "SKIP_REGULAR_EXPRESSION": SKIPPED, "FAIL_REGULAR_EXPRESSION": NO_TESTS}
        extra = dict(zip(self.options.properties[::2], self.options.properties[1::2]))
        texts = [text for item in {**everywhere, **properties, **extra}.items() for text in item]
        return f"add_test({name} {' '.join(map(quoted, command))})\nset_tests_properties({name} PROPERTIES {' '.join(map(quoted, texts))})\n"

    def quick(self, name, tests, count):
        """Entry of `count` quick tests. `tests`: filters of their names."""
        timeout = self.options.timeout * (SECONDS_SHARE + count - 1) // SECONDS_SHARE
        return self.entry(name, tests, {"TIMEOUT": str(timeout), "COST": f"{self.options.cost * count:g}"})

    def single(self, suite, tests):
        return "".join(self.quick(f"{suite}.{test}", [f"{suite}.{test}"], 1) for test in tests)

    def shared(self, suite, tests, is_whole):
        if any(matches(name, self.options.alone) for name in suite.split("/")):
            return self.single(suite, tests)
        parts = parts_of(tests, self.options.most)
        if len(parts) == 1:
            return self.quick(suite, [f"{suite}.*"] if is_whole else [f"{suite}.{test}" for test in tests], len(tests))
        return "".join(self.quick(f"{suite}_{number}", [f"{suite}.{test}" for test in part], len(part)) for number, part in enumerate(parts))

    def slow(self, suite, tests):
        properties = {"TIMEOUT": str(self.options.slow_timeout), "LABELS": "slow"}
        return "".join(self.entry(f"{suite}.{test}", [f"{suite}.{test}"], properties) for test in tests)

    def file(self, suites):
        single, shared, slow = "", "", ""
        for suite, tests in suites.items():
            kept = [test for test in tests if not matches(f"{suite}.{test}", self.options.omit)]
            slow_tests = [test for test in kept if matches(f"{suite}.{test}", self.options.slow)]
            quick_tests = [test for test in kept if test not in slow_tests]
            if quick_tests:
                single += self.single(suite, quick_tests)
                shared += self.shared(suite, quick_tests, quick_tests == tests)
            slow += self.slow(suite, slow_tests)
        return f"if(DEFINED ENV{{RELUME_SINGLE_TESTS}})\n{single}else()\n{shared}endif()\n{slow}"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("out", help="the file that ctest includes")
    parser.add_argument("--prefix", required=True, help="of the names of entries")
    parser.add_argument("--directory", required=True, help="working folder of the tests")
    parser.add_argument("--most", type=int, default=64, help="the most tests of an entry, if they have one parameter each")
    parser.add_argument("--timeout", type=int, required=True, help="of an entry with one test, seconds")
    parser.add_argument("--slow-timeout", type=int, required=True)
    parser.add_argument("--cost", type=float, default=0, help="estimated seconds of a quick test")
    for name, text in LISTS.items():
        parser.add_argument(f"--{name}", type=split, default=[], help=text)
    options = parser.parse_args()
    listed = subprocess.run([*options.emulator, options.program, "--gtest_list_tests"], cwd=options.directory, capture_output=True, text=True, timeout=LISTING_SECONDS, check=False)
    if listed.returncode != 0:
        sys.exit(f"{options.program} --gtest_list_tests fails with exit code {listed.returncode}; run it to find the fault\n{listed.stdout}{listed.stderr}")
    text = Writer(options).file(parse_listing(listed.stdout))
    with open(options.out, "w", encoding="utf-8") as file:
        file.write(text)


if __name__ == "__main__":
    main()
