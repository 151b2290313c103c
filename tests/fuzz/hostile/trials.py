#!/usr/bin/env python3
"""Hostile trials of the whole program: damaged input of every kind, odd command lines, and outputs where none can be written.

Every run must end within 30 s and 2 GB with exit code 0, 1 or 2, explain a failure in one line, and leave no partial
files. Trial N of seed S is reproducible: `trials.py --seed S --only N` repeats it."""

import argparse
import collections
import os
import pathlib
import random
import shlex
import shutil
import sys
import tempfile
import threading
import time

import cases
import command_lines
import judge
import process

WALL_S = 30
MEMORY_BYTES = 2 << 30
SHOWN_FAILURES = 50


class Trials:
    def __init__(self, options):
        self.options = options
        self.program = os.path.abspath(options.program)
        self.work = pathlib.Path(tempfile.mkdtemp(prefix="relume_hostile_"))
        self.failures = pathlib.Path(options.keep or tempfile.gettempdir()) / f"relume_hostile_failures_{os.getpid()}"
        # Sanitizers multiply memory use.
        self.memory = MEMORY_BYTES * (4 if "RELUME_SANITIZED" in os.environ else 1)
        self.began = time.monotonic()
        self.lock = threading.Lock()
        self.done = []  # entries: number, kind, run, problems
        self.kept = 0
        self.maker = cases.Maker(self.products(), {command: self.output_of(command, "--help-all") for command in command_lines.COMMANDS})

    def environment(self, folder):
        kept = {name: value for name, value in os.environ.items() if name in ("PATH", "LD_LIBRARY_PATH", "ASAN_OPTIONS", "UBSAN_OPTIONS", "LSAN_OPTIONS")}
        return {**kept, "HOME": str(folder), "XDG_CACHE_HOME": str(folder / "cache"), "LC_ALL": "C.UTF-8"}

    def execute(self, arguments, folder, stdout=""):
        out, err = folder.parent / "stdout", folder.parent / "stderr"
        return process.run([self.program, *arguments], folder, self.environment(folder), stdout or out, err, WALL_S, self.memory)

    def output_of(self, *arguments):
        done = self.execute(arguments, self.empty_folder("setup"))
        if done.exit_code != 0:
            sys.exit(f"hostile: {shlex.join(arguments)} failed: {done.stderr.decode(errors='replace')}")
        return done.stdout.decode()

    def empty_folder(self, name):
        folder = self.work / name / "a" / "case"
        shutil.rmtree(self.work / name, ignore_errors=True)
        (folder / "made").mkdir(parents=True)
        return folder

    def products(self):
        """Files written by the program, for trials to damage."""
        products = {"all.json": self.output_of("settings", "--json").encode()}
        for name, arguments in command_lines.CHECKPOINTS.items():
            folder = self.empty_folder("setup")
            done = self.execute([*arguments, "--spp", "2", "--resume", name, "-o", "out.exr"], folder)
            if done.exit_code != 0:
                sys.exit(f"hostile: no checkpoint can be made: {done.stderr.decode(errors='replace')}")
            products[name] = (folder / name).read_bytes()
            products["out.exr"] = (folder / "out.exr").read_bytes()
        return products

    def prepare(self, case, folder):
        for name in case.folders:
            (folder / name).mkdir(parents=True)
        for name, data in case.files.items():
            (folder / name).write_bytes(data)
        for name, target in case.links.items():
            (folder / name).symlink_to(target)
        if case.locked:
            (folder / case.locked).chmod(0o500)

    def trial(self, number, worker):
        case = self.maker.make(number, random.Random(f"{self.options.seed}/{number}"))
        folder = self.empty_folder(worker)
        self.prepare(case, folder)
        before = judge.snapshot(folder)
        run = self.execute(case.arguments, folder, case.stdout)
        problems = judge.judge(case, run, before, judge.snapshot(folder))
        outside = [p.name for level in (folder.parent, folder.parent.parent) for p in level.iterdir() if p.name not in ("case", "a", "stdout", "stderr")]
        problems += [f"wrote {name!r} outside its folder" for name in outside]
        if problems and self.kept < SHOWN_FAILURES:
            self.keep(number, case, worker, run, problems)
        return case, run, problems

    def keep(self, number, case, worker, run, problems):
        """Reports problems, and stores the input with a script that repeats the run."""
        folder = self.failures / str(number)
        shutil.rmtree(self.empty_folder(worker).parent.parent, ignore_errors=True)
        (folder / "made").mkdir(parents=True)
        self.prepare(case, folder)
        words = b" ".join(shlex.quote(os.fsdecode(a)).encode(errors="surrogateescape") for a in [self.program, *case.arguments])
        redirect = f" >{case.stdout}" if case.stdout else ""
        (folder / "run.sh").write_bytes(b'#!/bin/sh\ncd "$(dirname "$0")" && ' + words + redirect.encode() + b"\n")
        with self.lock:
            self.kept += 1
            print(f"trial {number} ({case.kind}): {'; '.join(problems)}\n  exit code {run.exit_code}, {run.seconds:.1f} s, says "
                  f"{run.stderr[-300:]!r}\n  again: sh {folder / 'run.sh'}   or: {sys.argv[0]} --seed {self.options.seed} --only {number}", flush=True)

    def work_off(self, numbers, worker):
        for number in numbers:
            case, run, problems = self.trial(number, worker)
            with self.lock:
                self.done.append((number, case.kind, run, problems))

    def run(self):
        numbers = [self.options.only] if self.options.only is not None else range(self.options.runs)
        jobs = self.options.jobs
        workers = [threading.Thread(target=self.work_off, args=(numbers[i::jobs], f"worker{i}")) for i in range(jobs)]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        shutil.rmtree(self.work, ignore_errors=True)
        if len(self.done) < len(numbers):
            print(f"hostile: {len(numbers) - len(self.done)} trials were not made; see above")
            return 1
        return self.summarise()

    def summarise(self):
        kinds, codes = collections.Counter(), collections.defaultdict(collections.Counter)
        for _, kind, run, problems in self.done:
            kinds[kind] += 1
            codes[kind][run.exit_code] += 1
            codes[kind]["bad"] += bool(problems)
        print(f"{'kind':<14} {'runs':>6} {'exit 0':>7} {'exit 1':>7} {'exit 2':>7} {'failed':>7}")
        for kind in sorted(kinds):
            print(f"{kind:<14} {kinds[kind]:>6} {codes[kind][0]:>7} {codes[kind][1]:>7} {codes[kind][2]:>7} {codes[kind]['bad']:>7}")
        slowest = max(self.done, key=lambda trial: trial[2].seconds)
        largest = max(self.done, key=lambda trial: trial[2].memory)
        print(f"longest run {slowest[2].seconds:.1f} s (trial {slowest[0]}, {slowest[1]}), largest memory {largest[2].memory >> 20} MiB (trial {largest[0]}, {largest[1]}), "
              f"{time.monotonic() - self.began:.0f} s in all")
        runs = [run for _, _, run, _ in self.done]
        signals = sum(run.exit_code < 0 and not run.hung and not run.too_large for run in runs)
        failed = sum(bool(problems) for *_, problems in self.done)
        if failed:
            print(f"{failed} trials failed")
        print(f"hostile: {len(runs)} runs, {signals} signals, {sum(run.hung for run in runs)} hangs, {sum(run.too_large for run in runs)} over 2 GB")
        return 1 if failed else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--program", default=os.environ.get("RELUME_PROGRAM"), help="the program under test [RELUME_PROGRAM]")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--runs", type=int, default=10000)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only", type=int, help="the number of one trial")
    parser.add_argument("--keep", help="folder for the input of failures [that for temporary files]")
    options = parser.parse_args()
    if not options.program:
        parser.error("give --program, or RELUME_PROGRAM in the environment")
    return Trials(options).run()


if __name__ == "__main__":
    sys.exit(main())
