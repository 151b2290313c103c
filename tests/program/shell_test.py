#!/usr/bin/env python3
"""Tests manual pages and completions: each covers every command and flag, and their readers report no errors."""

import os
import pty
import re
import select
import shutil
import subprocess
import sys
import time
import unittest

from program import ProgramTest, run

SKIPPED = 77  # ctest's exit code for skipped tests
TOOLS = ("man", "groff", "mandoc", "lexgrog", "bash", "zsh", "fish")
MISSING = [tool for tool in TOOLS if not shutil.which(tool)]
FLAG = re.compile(r"^  (?:-\w, )?--(\[no-\])?([\w.-]+)", re.MULTILINE)
# Print the arguments of zsh's _arguments instead of completing.
ZSH_STUBS = "compdef() {}\n_arguments() { if [[ $1 == -C ]]; then state=argument; else print -rl -- \"$@\"; fi }\n"
ZSH_PROMPT = b"READY> "


def needs(*tools):
    missing = [tool for tool in tools if tool in MISSING]
    return unittest.skipIf(missing, f"{', '.join(missing)} not installed")


def commands():
    text = run("--help").stdout
    return re.findall(r"^  (\w+) ", text[text.index("Commands:"):text.index("\nOptions:")], re.MULTILINE)


def flags(command):
    """Flags in the help: {"--spp", "--no-adaptive.pilot", …}."""
    found = set()
    for negation, name in FLAG.findall(run(command, "--help-all").stdout):
        found.add(f"--{name}")
        if negation:
            found.add(f"--no-{name}")
    return found


class ZshTerminal:
    """An interactive zsh with default settings that sourced a script."""

    def __init__(self, script, folder):
        self.process, self.terminal = pty.fork()
        if self.process == 0:
            os.chdir(folder)
            os.execvpe("zsh", ["zsh", "-f", "-i"], {**os.environ, "TERM": "dumb"})
        # The prompt is quoted so that the echo of this line does not contain it.
        self.send(f"PS1='REA''DY> '; stty cols 200; autoload -Uz compinit; compinit -u -D; source {script}\n")
        self.read_until(ZSH_PROMPT)

    def send(self, text):
        os.write(self.terminal, text.encode())

    def read_until(self, mark, limit_s=60):
        data = b""
        end = time.monotonic() + limit_s
        while mark not in data and time.monotonic() < end:
            if select.select([self.terminal], [], [], 0.2)[0]:
                data += os.read(self.terminal, 1 << 16)
        return data

    def completes(self, words, expected):
        """Whether a tab completes the line to `expected`."""
        self.send(words + "\t")
        done = self.read_until(expected.encode())
        self.send("\x15")  # clears the line
        return expected.encode() in done

    def close(self):
        os.close(self.terminal)
        os.waitpid(self.process, 0)


class Help(ProgramTest):
    def test_shows_the_flags_that_people_use_and_names_the_way_to_the_rest(self):
        for command in ("render", "view", "compare"):
            shown = [name for _, name in FLAG.findall(self.succeed(command, "--help").stdout)]
            self.assertEqual(len(shown), 10 + 2, command)  # the last two show help
            self.assertEqual(shown[-2:], ["help", "help-all"], command)
            self.assertLessEqual({f"--{name}" for name in shown}, flags(command), command)
            self.assertGreater(len(flags(command)), 100, command)
        self.assertIn("--watch", self.succeed("view", "--help").stdout)

    def test_commands_with_few_flags_show_all(self):
        self.assertEqual(self.succeed("info", "--help").stdout, self.succeed("info", "--help-all").stdout)
        self.assertNotIn("--help-all", self.succeed("info", "--help").stdout)


class ManualPages(ProgramTest):
    def setUp(self):
        super().setUp()
        self.succeed("man", "-o", "man1")
        self.pages = sorted((self.folder / "man1").iterdir())

    def test_every_command_has_its_page(self):
        names = ["relume.1"] + [f"relume-{command}.1" for command in commands()]
        self.assertEqual([page.name for page in self.pages], sorted(names))
        self.assertGreater(len(names), 10)
        self.assertEqual(self.succeed("man").stdout, (self.folder / "man1/relume.1").read_text())

    def test_pages_have_their_sections(self):
        for page in self.pages:
            sections = re.findall(r"^\.SH (.*)", page.read_text(), re.MULTILINE)
            for section in ("NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "EXAMPLES", "EXIT STATUS", "SEE ALSO"):
                self.assertIn(section, sections, page.name)

    def test_pages_explain_every_flag(self):
        for command in commands():
            page = self.succeed("man", command).stdout
            explained = set(re.findall(r"\\fB(--[\w.-]+)\\fR", page.replace("\\-", "-")))
            self.assertEqual(flags(command) - explained, set(), command)

    @needs("man", "groff", "mandoc")
    def test_formatters_find_no_fault(self):
        for page in self.pages:
            for tool in (["man", "--warnings=w", "-l"], ["groff", "-ww", "-man", "-Tutf8", "-z"], ["mandoc", "-T", "lint"]):
                done = subprocess.run([*tool, page], capture_output=True, text=True, check=True, env={**os.environ, "LC_ALL": "C.UTF-8", "MANROFFSEQ": ""})
                notes = done.stdout if tool[0] == "mandoc" else ""
                self.assertEqual(notes + done.stderr, "", f"{tool[0]}: {page.name}")

    @needs("lexgrog")
    def test_the_index_of_manual_pages_finds_the_names(self):
        done = subprocess.run(["lexgrog", *self.pages], capture_output=True, text=True, check=True)
        self.assertEqual(len(done.stdout.splitlines()), len(self.pages), done.stdout)

    def test_pages_are_the_same_on_every_day(self):
        heading = r'\.TH RELUME-RENDER 1 \d{4}-\d\d-\d\d "relume [\d.]+" "User Commands"'
        self.assertRegex(self.succeed("man", "render").stdout, heading)
        moved = self.succeed("man", "render", env={**os.environ, "TZ": "Asia/Tokyo", "LC_ALL": "C", "SOURCE_DATE_EPOCH": "0"}).stdout
        self.assertEqual(moved, self.succeed("man", "render").stdout)


class Completions(ProgramTest):
    def script(self, shell):
        file = self.folder / f"relume.{shell}"
        file.write_text(self.succeed("completion", shell).stdout)
        subprocess.run([shell, "-n", file], check=True)
        return file

    def output(self, shell, text):
        options = {"bash": ["--norc"], "zsh": ["-f"], "fish": ["--no-config"]}[shell]
        return subprocess.run([shell, *options, "-c", text], cwd=self.folder, capture_output=True, text=True, check=True).stdout

    def bash_offers(self, script, words):
        return self.output("bash", f"source {script}; compopt() {{ :; }}; COMP_WORDS=(relume {words}); "
                           "COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _relume; printf '%s\\n' \"${COMPREPLY[@]}\"").splitlines()

    def fish_offers(self, script, words):
        lines = self.output("fish", f"source {script}; complete -C 'relume {words}'").splitlines()
        return [line.split("\t")[0] for line in lines]

    def check_offers(self, offers):
        """`offers` returns the shell's completions of the last word."""
        self.assertLessEqual(set(commands()), set(offers("''")))
        for command in commands():
            self.assertEqual(flags(command) - set(offers(f"{command} --")), set(), command)
        self.assertEqual(offers("render x --lights p"), ["power"])
        self.assertEqual(offers("man ren"), ["render"])
        self.assertIn("cornell", offers("render corn"))
        (self.folder / "a scene.glb").touch()
        self.assertEqual([offer.replace("\\ ", " ") for offer in offers("render a")][:1], ["a scene.glb"])

    @needs("bash")
    def test_bash(self):
        script = self.script("bash")
        self.check_offers(lambda words: self.bash_offers(script, words))

    @needs("fish")
    def test_fish(self):
        script = self.script("fish")
        self.check_offers(lambda words: self.fish_offers(script, words.replace("''", "")))

    @needs("zsh")
    def test_zsh(self):
        script = self.script("zsh")
        for command in commands():
            specifications = self.output("zsh", f"{ZSH_STUBS}source {script}; words=({command}); _relume")
            known = set(re.findall(r"^(?:\([^)]*\)|\*)?(--?[\w.-]+)", specifications, re.MULTILINE))
            self.assertEqual(flags(command) - known, set(), command)
        (self.folder / "a scene.glb").touch()
        zsh = ZshTerminal(script, self.folder)
        self.addCleanup(zsh.close)
        for words, line in (("relume comple", "completion "), ("relume render --sp", "--spp="), ("relume render x --lights po", "power "),
                            ("relume man ren", "man render "), ("relume render cornell-w", "cornell-water "), ("relume render -o a", "a\\ scene.glb")):
            self.assertTrue(zsh.completes(words, line), words)


if __name__ == "__main__":
    done = unittest.main(exit=False).result
    if done.wasSuccessful() and MISSING:
        print(f"{', '.join(MISSING)} not installed; scripts/install_packages installs them")
        sys.exit(SKIPPED)
    sys.exit(not done.wasSuccessful())
