"""Command lines of valid and invalid flags and values, based on the program's help."""

import re

import images
from damage import EXTREME_NUMBERS, ODD_STRINGS
from trial_case import SMALL, Case

COMMANDS = ["render", "export", "info", "metrics", "merge", "compare", "experiment", "settings", "devices", "man", "completion", "scenes"]
OPTION = re.compile(r"^  (?:-\w, )?--(\[no-\])?([\w.-]+)(?: (\S+))?", re.MULTILINE)

# Commands that write the checkpoints to damage.
CHECKPOINTS = {
    "plain.ckpt": ["render", "cornell", *SMALL], "psf.ckpt": ["render", "cornell", *SMALL, "--cache", "psf"],
    "guided.ckpt": ["render", "cornell", *SMALL, "--lights", "vlc", "--guide", "cdq"], "adaptive.ckpt": ["render", "cornell", *SMALL, "--allocation", "adaptive"],
    "denoised.ckpt": ["render", "turntable", *SMALL, "--history", "reproject", "--denoise", "svgf"],
}

# Values for flags whose valid values can take minutes or gigabytes, or that write files or connect.
CAREFUL = {
    "width": ["0", "-1", "1", "7", "nan", "1e308", "32769", "2147483648", "", "x"], "height": ["0", "-1", "1", "5", "inf", "1.5", "32769", "4294967297"],
    "spp": ["0", "1", "3", "-1", "1.5", "1073741825", "99999999999999999999", "x"], "reference-spp": ["2", "3", "1", "0", "-1", "x"], "repeat": ["1", "2", "0", "-1", "1e9"],
    "timing": ["1", "2", "0", "-1", "x"], "budget": ["1ms", "0", "-1", "1e308", "x", "5"], "time": ["0", "1ms", "1s", "-1", "nan", "1e999", "10 parsecs"],
    "threads": ["0", "1", "2", "-1", "1025", "x"], "frames": ["0", "0-1", "1-0", "-1", "x", "0-", "-", "0-1000001", "0-99999999999999999999", "3-3", "0-1-2"],
    "static-lists.rays": ["64", "63", "1048577", "-1", "x"], "psf.max-cells": ["0", "1", "1024", "268435457", "-1"], "error": ["0", "1", "-1", "nan", "1e-320"],
    "output": ["made/a.exr", "made/a.png", "made/a.jpg", "made/a.tga", "made/a.hdr", "made/a.glb", "made/a.gltf", "made/page", "made/p.html", "nowhere/a.exr", "", "made", "made/a.gif", "made/a.y4m"],
    "stats": ["made/s.json", "nowhere/s.json", "made", ""], "resume": ["made/a.ckpt", "nowhere/a.ckpt", "made", "", "a.exr"], "flip-map": ["made/f.png", "made/f.exr", "made", "made/f.gif", ""],
    "cache-dir": ["cache", "cache/deeper", "a.exr"], "display": ["x", "127.0.0.1:1", ":", "127.0.0.1:99999", "127.0.0.1:x", ""], "scenes": ["nowhere", "."], "quick": [], "continue": [],
}
TEXTS = ["cornell", "furnace", "a.exr", "few.json", "albedo", "albedo,normal", "albdo", "default", "psf", "default,psf", "a=lights:uniform,b=cache:psf", "x=a.exr", "=", ",", ",,", ":", "lights:uniform", "lights:", "1,2,3", "1,2",
         "none", "preview", "reference", "interactive", "paper-002", "--", "-", "-1", "true", "false", "0.5", "1", "2", "10", "100"]
POSITIONAL = {"render": 1, "export": 1, "info": 1, "metrics": 2, "merge": 2, "compare": 1, "man": 1, "completion": 1}


def odd_text(rng):
    """A value that is a possible argument, without zero bytes."""
    if rng.random() < 0.5:
        return rng.choice(EXTREME_NUMBERS)
    return rng.choice([text for text in ODD_STRINGS if b"\0" not in text])


class CommandLines:
    def __init__(self, helps):
        self.options = {command: self.parse(helps[command]) for command in COMMANDS}

    @staticmethod
    def parse(text):
        """Value of each flag by name, according to the help: None, a word, or choices separated by |."""
        found = {}
        for negatable, name, value in OPTION.findall(text):
            if name == "all":  # runs every experiment
                continue
            found[name] = value or None
            if negatable:
                found["no-" + name] = None
        assert "help" in found, "help without options"
        return found

    def value(self, name, kind, rng):
        if name in CAREFUL:
            return rng.choice(CAREFUL[name] or ["x"])
        chance = rng.random()
        if kind and "|" in kind and chance < 0.6:
            return rng.choice(kind.split("|"))
        if chance < 0.8:
            return rng.choice(TEXTS) if rng.random() < 0.7 else rng.choice(EXTREME_NUMBERS)
        return odd_text(rng)

    def flag(self, command, rng):
        """A flag, usually of this command, with or without a value."""
        name = rng.choice(list(self.options[command if rng.random() < 0.95 else rng.choice(COMMANDS)]))
        kind = next((options[name] for options in self.options.values() if name in options), None)
        if name in CAREFUL and not CAREFUL[name]:
            return ["--" + name]
        if kind is None and name not in CAREFUL:
            return [f"--{name}" if rng.random() < 0.9 else f"--{name}={rng.choice(TEXTS)}"]
        value = self.value(name, kind, rng)
        chance = rng.random()
        if chance < 0.03:
            return ["--" + name]
        if chance < 0.06:
            return ["--" + name[:-1] if len(name) > 3 else "-" + name, value]
        return ["--" + name, value] if isinstance(value, bytes) or chance < 0.8 else [f"--{name}={value}"]

    def positional(self, command, rng):
        if command == "experiment":  # valid names would take minutes
            return rng.choice((["list"], ["run", "x"], ["rnu"], [], ["list", "x"], ["run", odd_text(rng)]))
        if command == "man" or command == "completion":
            return [rng.choice((*COMMANDS, "bash", "zsh", "fish", "tcsh", ""))]
        count = max(0, POSITIONAL.get(command, 0) + rng.choice((0, 0, 0, 0, 0, 0, 0, -1, 1)))
        return [rng.choice(("cornell", "furnace", "a.exr", "cornell", "a.exr")) if rng.random() < 0.9 else odd_text(rng) for _ in range(count)]

    def make(self, rng):
        command = rng.choice(COMMANDS + 6 * ["render"] + 2 * ["compare", "metrics", "export"])
        arguments = self.positional(command, rng)
        if command in ("render", "compare"):
            arguments += SMALL
        if command == "compare":
            arguments += ["--repeat", "1", "--reference-spp", "2", "--cache-dir", "cache"]
        if command in ("render", "compare", "export") and rng.random() < 0.9:
            arguments += ["-o", {"render": "made/a.exr", "compare": "made/page", "export": "made/a.glb"}[command]]
        for _ in range(rng.choice((0, 1, 1, 2, 3, 8))):
            arguments += self.flag(command, rng)
        if rng.random() < 0.05:
            command = odd_text(rng)
        files = {"a.exr": images.exr(), "few.json": b'{"max-bounces": 2}'}
        # Without -o, pages of comparisons are written next to the scene.
        return Case("command line", [command, *arguments], files, may_change=["*-compare/*", "experiments/*", "made.*"])
