#!/usr/bin/env python3
"""Tests invalid input: one clear message, a nonzero exit code, and no new files."""

import json
import os
import struct
import subprocess
import unittest

from program import PROGRAM, SMALL, ProgramTest, run, write_gltf

FAILED, USAGE = 1, 2


def write_bare_exr(file, value, width=8, height=8):
    """Writes an EXR without relume's attributes and with this value in all pixels (OpenEXR file layout, uncompressed)."""
    def attribute(name, kind, data):
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(data)) + data

    of_floats = struct.pack("<iB3xii", 2, 0, 1, 1)
    channels = b"".join(name + b"\0" + of_floats for name in (b"B", b"G", b"R")) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header = b"\x76\x2f\x31\x01" + struct.pack("<i", 2) + attribute("channels", "chlist", channels)
    header += attribute("compression", "compression", b"\0") + attribute("lineOrder", "lineOrder", b"\0")
    header += attribute("dataWindow", "box2i", window) + attribute("displayWindow", "box2i", window)
    header += attribute("pixelAspectRatio", "float", struct.pack("<f", 1)) + attribute("screenWindowWidth", "float", struct.pack("<f", 1))
    header += attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)) + b"\0"
    row = struct.pack(f"<{3 * width}f", *[value] * (3 * width))
    first = len(header) + 8 * height
    offsets = struct.pack(f"<{height}Q", *(first + y * (8 + len(row)) for y in range(height)))
    file.write_bytes(header + offsets + b"".join(struct.pack("<2i", y, len(row)) + row for y in range(height)))


class RefusalTest(ProgramTest):
    def refuse(self, code, *arguments, says=(), matches=".", env=None):
        """Expects failure with one message that contains all of `says` and matches `matches`, and no new file."""
        before = self.files()
        done = run(*arguments, cwd=self.folder, env=env)
        self.assertEqual(done.returncode, code, done.stderr)
        lines = done.stderr.splitlines()
        self.assertEqual(len(lines), 1, done.stderr)
        self.assertTrue(lines[0].startswith("relume: "), lines[0])
        for text in says:
            self.assertIn(text, lines[0])
        self.assertRegex(lines[0], matches)
        self.assertEqual(done.stdout, "")
        self.assertEqual(self.files(), before)

    def refuse_each(self, command, rows):
        """Each row: exit code, arguments after the command, and a pattern for the message."""
        for code, words, matches in rows:
            with self.subTest(words=words):
                self.refuse(code, *command, *words.split(), matches=matches)

    def render(self, *arguments):
        return ("render", "cornell", *SMALL, "--spp", "1", *arguments)


class Errors(RefusalTest):
    def test_error_without_history(self):
        self.refuse(USAGE, "render", "cornell", *SMALL, "-o", "out.exr", "--error", "0.1", "--history", "none", says=["--error", "--history", "--spp"])

    def test_unknown_scene(self):
        self.refuse(FAILED, "render", "cornel", "-o", "out.exr", *SMALL, says=["cornel", "cornell"])

    def test_missing_file(self):
        self.refuse(FAILED, "render", "no/such.glb", "-o", "out.exr", *SMALL, says=["no/such.glb"])

    def test_names_that_no_file_may_have(self):
        long = "n" * 300
        write_gltf(self.folder / "a.gltf", {"nodes": [{"mesh": 0}], "buffers": [{"byteLength": 36, "uri": long}]})
        (self.folder / "a.json").write_text(json.dumps({"scene": long}))
        self.refuse(FAILED, "info", "a.gltf", says=["a.gltf: its buffer '" + long, "cannot be reached (File name too long); put the file beside it"])
        self.refuse(FAILED, "info", "a.json", says=["a.json: scene is " + long, "cannot be reached (File name too long); check its path"])
        self.refuse(FAILED, "compare", "cornell", "--image", f"x={long}.exr", says=["the file of --image cannot be reached (File name too long); check its path"])

    def test_unknown_command(self):
        self.refuse(USAGE, "rendr", "cornell", says=["'rendr'", "did you mean 'render'"])

    def test_unknown_flag(self):
        self.refuse(USAGE, *self.render("-o", "out.exr", "--max-bounce", "3"), says=["--max-bounce", "did you mean --max-bounces"])

    def test_no_output(self):
        self.refuse(USAGE, *self.render(), says=["-o FILE"])

    def test_no_scene(self):
        self.refuse(USAGE, "render", "-o", "out.exr", says=["SCENE"])

    def test_empty_image(self):
        for flag in ("--width", "--height"):
            self.refuse(USAGE, "render", "cornell", "-o", "out.exr", flag, "0", says=[flag, "0"])
        self.refuse(USAGE, "render", "cornell", "-o", "out.exr", "--width", "-4", says=["--width"])

    def test_numbers_that_are_none(self):
        self.refuse(USAGE, *self.render("-o", "out.exr", "--seed", "x"), says=["--seed", "'x'"])
        self.refuse(USAGE, *self.render("-o", "out.exr", "--seed", "900000001"), says=["--seed", "900000000"])
        self.refuse(USAGE, *self.render("-o", "out.exr", "--exposure", "nan"), says=["--exposure"])
        self.refuse(USAGE, *self.render("-o", "out.exr", "--time", "soon"), says=["--time"])

    def test_timing_with_options_for_images(self):
        for other in (("--budget", "1s"), ("-o", "out"), ("--reference", "a.exr"), ("--reference-settings", "lights:uniform")):
            self.refuse(USAGE, "compare", "cornell", *SMALL, "--timing", "4", *other, says=["--timing", "remove"])

    def test_unknown_choice(self):
        self.refuse(USAGE, *self.render("-o", "out.exr", "--lights", "pwoer"), says=["--lights", "power"])

    def test_output_in_a_missing_folder(self):
        self.refuse(USAGE, *self.render("-o", "nowhere/out.exr"), says=["nowhere"])

    def test_output_that_is_a_folder(self):
        (self.folder / "out.exr").mkdir()
        self.refuse(USAGE, *self.render("-o", "out.exr"), says=["out.exr is a folder"])

    @unittest.skipIf(os.geteuid() == 0, "nothing is unwritable for root")
    def test_output_in_a_locked_folder(self):
        self.folder.chmod(0o500)
        self.addCleanup(self.folder.chmod, 0o700)
        self.refuse(USAGE, *self.render("-o", "out.exr"), says=["cannot be written"])

    def test_output_of_unknown_kind(self):
        self.refuse(USAGE, *self.render("-o", "out.gif"), says=["out.gif", ".exr"])

    def test_layers_without_exr(self):
        self.refuse(USAGE, *self.render("-o", "out.png", "--aov", "albedo"), says=[".exr"])

    def test_unknown_layer(self):
        self.refuse(USAGE, *self.render("-o", "out.exr", "--aov", "albdo"), says=["albdo", "albedo"])

    def test_bad_environment(self):
        self.refuse(FAILED, *self.render("-o", "out.exr", "--env", "1,2"), says=["1,2"])
        self.refuse(FAILED, *self.render("-o", "out.exr", "--env", "1,-2,3"), says=["1,-2,3"])
        self.refuse(FAILED, *self.render("-o", "out.exr", "--env", "sky.hdr"), says=["sky.hdr"])
        (self.folder / "sky.hdr").write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 4\n\x02")
        self.refuse(FAILED, *self.render("-o", "out.exr", "--env", "sky.hdr"), says=["sky.hdr"])

    def test_unknown_preset(self):
        self.refuse(FAILED, *self.render("-o", "out.exr", "--preset", "fast-ish"), says=["fast-ish"])

    def test_unknown_camera(self):
        self.refuse(FAILED, *self.render("-o", "out.exr", "--camera", "Door"), says=["Door", "camera"])

    def test_bad_settings_file(self):
        self.refuse(FAILED, *self.render("-o", "out.exr", "--settings", "none.json"), says=["none.json"])
        for text, says in (('{"max-bounces": ', "line 1"), ('{"max-bounce": 3}', "max-bounces"), ('{"max-bounces": -1}', "max-bounces"), ("[]", "object")):
            (self.folder / "s.json").write_text(text)
            self.refuse(FAILED, *self.render("-o", "out.exr", "--settings", "s.json"), says=["s.json", says])

    def test_bad_frames(self):
        for frames in ("5-2", "x", "-3", "1-9999999"):
            self.refuse(USAGE, *self.render("-o", "out.exr", f"--frames={frames}"), says=["--frames"])
        self.refuse(USAGE, *self.render("-o", "out.mp4", "--frames", "0-1", "--resume", "a.ckpt"), says=["--resume"])
        self.refuse(USAGE, *self.render("-o", "out.MP4", "--frames", "0-1", "--aov", "albedo"), says=["--aov"])
        self.refuse(USAGE, *self.render("-o", "out.exr", "--frames", "1000001", "--fps", "1"), says=["--frames"])

    def test_display_that_is_not_there(self):
        self.refuse(FAILED, *self.render("-o", "out.exr", "--quiet", "--display", "127.0.0.1:1"), says=["127.0.0.1"])

    def test_metrics_of_unlike_images(self):
        self.succeed(*self.render("-o", "a.exr"))
        self.succeed("render", "cornell", "-o", "b.exr", "--width", "8", "--height", "8", "--spp", "1")
        self.refuse(FAILED, "metrics", "a.exr", "b.exr", says=["8 x 8"])
        self.refuse(FAILED, "metrics", "a.exr", "none.exr", says=["none.exr"])

    def test_export_of_unknown_kind(self):
        self.refuse(USAGE, "export", "cornell", "-o", "c.obj", says=["c.obj"])

    def test_full_disk(self):
        with open("/dev/full", "w", encoding="utf-8") as full:
            for command in (["scenes"], ["info", "cornell"], ["settings"]):
                done = subprocess.run([PROGRAM, *command], stdout=full, stderr=subprocess.PIPE, text=True, check=False)
                self.assertEqual(done.returncode, FAILED, command)
                self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)

    def test_half_a_scene_file(self):
        self.succeed("export", "cornell", "-o", "c.glb")
        whole = (self.folder / "c.glb").read_bytes()
        (self.folder / "c.glb").write_bytes(whole[: len(whole) // 2])
        self.refuse(FAILED, "render", "c.glb", "-o", "out.exr", *SMALL, says=["c.glb"])


class Combinations(RefusalTest):
    """Combinations rejected according to docs/combinations.md and the techniques' pages."""

    def test_slots(self):
        self.refuse_each(self.render("-o", "out.exr"), [
            (FAILED, "--reuse restir-di+gi --guide mcpg --no-mcpg.nee", "guide 'mcpg' without mcpg.nee .* 'restir-di.gi' .*: their samples are points on lights .*; use mcpg.nee on, or reuse 'none'"),
            (FAILED, "--reuse restir-pt --guide mcpg --no-mcpg.nee", "guide 'mcpg' without mcpg.nee .* 'restir-pt': their samples are points on lights .*; use mcpg.nee on, or reuse 'none'"),
            (FAILED, "--estimator vcm --guide mcpg --no-mcpg.nee", "guide 'mcpg' without mcpg.nee .* estimators 'bdpt' and 'vcm': without next event estimation, no point .*; use mcpg.nee on, or estimator 'path'"),
            (FAILED, "--guide mcpg --no-mcpg.nee --cache psf --reuse ris", "guide 'mcpg' without mcpg.nee .* reuse 'ris'.*; use mcpg.nee on, or reuse 'none'"),
            (FAILED, "--estimator light --reuse restir-gi", "reuse 'restir-gi', .* estimator 'light'.*; use reuse 'ris' or 'restir-di'"),
            (FAILED, "--estimator light --lights vlc", "guides 'cdq' and 'mcpg' do not combine with estimator 'light'.*; use estimator 'bdpt'"),
            (FAILED, "--estimator light --guide cdq --cdq.importance --lights vlc", "guides 'cdq' and 'mcpg' do not combine with estimator 'light'.*; use estimator 'bdpt'"),
            (FAILED, "--estimator light --guide cdq", "guides 'cdq' and 'mcpg' do not combine with estimator 'light'.*; use .* guide 'bsdf'"),
            (FAILED, "--estimator light --lights mcls", "guides 'cdq' and 'mcpg' do not combine with estimator 'light'.*; use estimator 'bdpt'"),
            (FAILED, "--estimator light --guide mcpg", "guides 'cdq' and 'mcpg' do not combine with estimator 'light'.*; use .* guide 'bsdf'"),
            (FAILED, "--estimator light --cache apsf", "estimator 'light' .* radiance cache.*; use estimator 'bdpt' or cache 'none'"),
            (FAILED, "--estimator bdpt --cache apg", "estimators 'bdpt' and 'vcm' .* caches 'apg', 'apsf\\+apg' and 'sharc'.*; use cache 'psf' or 'apsf'"),
            (FAILED, "--estimator vcm --cache apsf+apg", "estimators 'bdpt' and 'vcm' .* 'apg'.* estimator 'path'"),
            (FAILED, "--allocation adaptive --history none", "allocation 'adaptive' .* history 'none'.*; use history 'accumulate' or 'reproject'"),
            # From any source of choices.
            (FAILED, "--preset restir-pt-2022 --estimator bdpt", "reuse 'restir-pt' does not combine with estimators 'bdpt' and 'vcm'"),
            (FAILED, "--preset paper-001 --history none", "allocation 'adaptive' .* history 'none'"),
        ])
        (self.folder / "s.json").write_text('{"cache": "psf", "estimator": "light"}')
        self.refuse(FAILED, *self.render("-o", "out.exr", "--settings", "s.json"), matches="estimator 'light' .* radiance cache")

    def test_values(self):
        self.refuse_each(self.render("-o", "out.exr"), [
            (FAILED, "--allocation adaptive --adaptive.max 4 --adaptive.min 4", r"adaptive\.max is 4 .*adaptive\.min is 4, .* --adaptive\.max 5"),
            (FAILED, "--cache apsf --apsf.survival-v0 2 --apsf.survival-v1 2", r"apsf\.survival-v0 is 2 .*apsf\.survival-v1 is 2, .* v1 must exceed v0"),
            (FAILED, "--cache apsf --apsf.error-v0 0.5", r"apsf\.error-v0 is 0\.5 .*apsf\.error-v1 is 0\.008, .* v1 must exceed v0"),
            (FAILED, "--cache apsf+apg --apsf.blend-v0 0.5", r"apsf\.blend-v0 is 0\.5 .*apsf\.blend-v1 is 0\.2, .* v1 must exceed v0"),
            # With a difference of 8, the thesis divides by zero.
            (FAILED, "--cache apsf --apsf.survival-v0 1 --apsf.survival-v1 9", r"apsf\.survival-v1 is 9, .* by less than 8"),
            (FAILED, "--cache apsf --apsf.blend-v0 0 --apsf.blend-v1 8", r"apsf\.blend-v1 is 8, .* by less than 8"),
        ])
        self.succeed(*self.render("-o", "out.exr", "--cache", "apsf", "--apsf.survival-v0", "1", "--apsf.survival-v1", "8.5"))

    def test_a_library_that_is_missing(self):
        command = self.render("-o", "out.exr", "--denoise", "oidn")
        if run(*command, cwd=self.folder).returncode == 0:
            self.skipTest("this relume was built with Open Image Denoise")
        self.refuse(FAILED, *command, matches=r"denoise 'oidn' needs .*Open Image Denoise.* https://www\.openimagedenoise\.org, .* or use denoise 'bmfr' or 'svgf'")


class Checkpoints(RefusalTest):
    def setUp(self):
        super().setUp()
        self.succeed(*self.render("-o", "a.exr", "--resume", "a.ckpt"))
        (self.folder / "a.exr").unlink()
        self.checkpoint = (self.folder / "a.ckpt").read_bytes()

    def test_of_another_image(self):
        self.refuse_each(self.render("-o", "out.exr", "--resume", "a.ckpt"), [
            (FAILED, "--seed 3", r'a\.ckpt: .* made with other settings \("seed": 0, now "seed": 3\); use those or delete it'),
            (FAILED, "--height 19", r'a\.ckpt: .* other settings \("height": 18, now "height": 19\)'),
            (FAILED, "--lights uniform", r'a\.ckpt: .* other settings \("lights": "power", now "lights": "uniform"\)'),
            (FAILED, "--aov albedo", r"a\.ckpt: .* other settings \(without auxiliary buffers\)"),
            (FAILED, "--scene-time 1", r"a\.ckpt: .* made at time 0 s, which is not requested; use the same"),
            (FAILED, "--frames 3-4", r"a\.ckpt: .* made at time 0 s, which is not requested; use the same frames"),
        ])
        self.refuse(FAILED, "render", "furnace", *SMALL, "--spp", "1", "-o", "out.exr", "--resume", "a.ckpt",
                    matches=r"a\.ckpt: .* belongs to another scene; delete it to start over")
        self.assertEqual((self.folder / "a.ckpt").read_bytes(), self.checkpoint)

    def test_damaged(self):
        middle = len(self.checkpoint) // 2
        changed = bytearray(self.checkpoint)
        changed[middle] ^= 1
        damages = {
            "cut off": (self.checkpoint[:middle], "is damaged or incomplete; delete it to start over"),
            "without its end": (self.checkpoint[:-1], "is damaged or incomplete; delete it to start over"),
            "a bit changed": (bytes(changed), "is damaged or incomplete; delete it to start over"),
            "something else": (b"no checkpoint, but long enough to be one", "not a checkpoint of this version of relume; delete it"),
        }
        for what, (data, matches) in damages.items():
            with self.subTest(what):
                (self.folder / "a.ckpt").write_bytes(data)
                self.refuse(FAILED, *self.render("-o", "out.exr", "--resume", "a.ckpt"), matches=r"a\.ckpt: .*" + matches)
                self.assertEqual((self.folder / "a.ckpt").read_bytes(), data)


class Commands(RefusalTest):
    def test_compare_replaces_none_of_its_inputs(self):
        scene = b'{"scene": "builtin:cornell"}'
        (self.folder / "evening.json").write_bytes(scene)
        (self.folder / "mine.json").write_bytes(b'{"lights": "uniform"}')
        for arguments in (["evening.json", "-o", "evening.html"], ["cornell", "--techniques", "default,mine.json", "-o", "mine.html"]):
            self.refuse(USAGE, "compare", *arguments, *SMALL, "--cache-dir", "cache", says=[".json", "-o would replace ", " reads; choose another name for -o"])
        self.assertEqual((self.folder / "evening.json").read_bytes(), scene)

    def test_compare(self):
        write_bare_exr(self.folder / "small.exr", 0.5)
        write_bare_exr(self.folder / "fits.exr", 0.5, 24, 18)
        write_bare_exr(self.folder / "nan.exr", float("nan"), 24, 18)
        self.refuse_each(["compare", "cornell", *SMALL, "-o", "page.html", "--cache-dir", "cache"], [
            (USAGE, "--spp 4 --budget 1s", "--spp .* equal samples and --budget .* equal time; choose one"),
            (USAGE, "--time 5s", "compare has no --time; use --budget to compare at equal time"),
            (USAGE, "--error 0.1", "compare has no --error; use --spp to compare at equal samples"),
            (FAILED, "--techniques default,default", "--techniques: two contenders are called 'default'; rename one with NAME="),
            (FAILED, "--techniques a=lights:uniform,a=lights:power", "--techniques: two contenders are called 'a'"),
            (FAILED, "--image a=small.exr --image a=fits.exr", "--image: two contenders are called 'a'"),
            (USAGE, "--techniques psf --image psf=fits.exr", "two contenders are called 'psf'; rename the image with --image NAME=FILE"),
            (FAILED, "--techniques a=width:8", "a: width is common to all contenders; give it as --width"),
            (FAILED, "--techniques small.exr", r"small\.exr: .* no attribute 'relume\.settings'"),
            (FAILED, "--reference small.exr", r"small\.exr has 8x8 pixels, but 24x18 are compared; give --width and --height"),
            (FAILED, "--reference fits.exr --frames 0-3", "--reference reads one image, but --frames compares several; remove one of the two"),
            (FAILED, "--reference nan.exr", r"nan\.exr: the image has no finite pixel; check its source"),
            (FAILED, "--image nan.exr", r"nan\.exr: the image has no finite pixel; check its source"),
            (USAGE, "--reference fits.exr --reference-settings lights:uniform", "--reference reads an image.* --reference-settings .*; choose one"),
            (FAILED, "--reference-settings lights", "--reference-settings: 'lights' is not KEY:VALUE"),
            (FAILED, "--reference-settings lihgts:power", "--reference-settings: there is no setting 'lihgts'; did you mean 'lights'"),
            (FAILED, "--reference-settings width:8", "--reference-settings: width is common to all contenders; give it as --width"),
            (FAILED, "--reference-settings cache:psf,estimator:light", "estimator 'light' .* radiance cache"),
        ])

    def test_experiment(self):
        self.refuse_each(["experiment"], [
            (USAGE, "", "experiment needs ACTION"),
            (USAGE, "rnu", "experiment has no action 'rnu'; use list or run"),
            (USAGE, "run", "experiment run needs names or --all; `relume experiment list` shows them"),
            (USAGE, "run reprojection --all", "experiment run takes names or --all, not both"),
            (FAILED, "run reprojektion", "no experiment 'reprojektion'; did you mean 'reprojection'"),
        ])

    def test_completion_of_another_shell(self):
        self.refuse_each(["completion"], [(USAGE, "tcsh", "no completion for 'tcsh'; use bash, zsh, fish"), (USAGE, "", "completion needs SHELL")])

    def test_control_characters_reach_no_terminal(self):
        self.refuse(USAGE, "ren\nder\x1b[2J", says=[r"'ren\nder\x1b[2J'"])
        (self.folder / "s.json").write_text(r'{"exposure": "a\nb\u001b[31m"}')
        self.refuse(FAILED, "render", "cornell", "--settings", "s.json", "-o", "out.exr", says=[r"'a\nb\x1b[31m'"])
        write_bare_exr(self.folder / "odd.exr", 0.5)
        data = (self.folder / "odd.exr").read_bytes()
        (self.folder / "odd.exr").write_bytes(data.replace(b"R\0" + struct.pack("<i", 2), b"\x1b\0" + struct.pack("<i", 2)))
        self.assertIn(r"\x1b from 0.5", self.succeed("info", "odd.exr").stdout)

    def test_settings_of_a_image_that_has_none(self):
        write_bare_exr(self.folder / "bare.exr", 0.5)
        self.refuse(FAILED, *self.render("-o", "out.exr", "--settings", "bare.exr"), matches=r"bare\.exr: .* no attribute 'relume\.settings'; only EXR files that relume wrote")

    def test_a_window_without_a_display(self):
        environment = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
        self.refuse(FAILED, "view", "cornell", "--smoke", "1", env=environment, matches="needs a display, such as X11 or `xvfb-run`|was built without its viewer")

    def test_scenes_without_triangles(self):
        vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
        (self.folder / "points.obj").write_text(vertices + "p 1 2 3\n")
        (self.folder / "lines.obj").write_text(vertices + "l 1 2 3\n")
        (self.folder / "vertices.obj").write_text(vertices)
        header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        (self.folder / "points.ply").write_text(header + "end_header\n0 0 0\n1 0 0\n0 1 0\n")
        (self.folder / "faceless.ply").write_text(header + "element face 0\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n")
        for file in ("points.obj", "lines.obj", "vertices.obj", "points.ply", "faceless.ply"):
            with self.subTest(file=file):
                self.refuse(FAILED, "render", file, "-o", "out.exr", *SMALL, matches=rf"{file}: the file has no triangles; (check that it is the right one|point clouds are not supported, convert it to a mesh)")
        for file in ("points.ply", "faceless.ply"):
            self.refuse(FAILED, "info", file, says=["has no triangles", "point clouds are not supported"])

    def test_metrics_of_nothing_that_is_finite(self):
        write_bare_exr(self.folder / "nan.exr", float("nan"))
        write_bare_exr(self.folder / "grey.exr", 0.5)
        self.assertEqual(self.metrics("grey.exr", "grey.exr")["mean_a"], [0.5] * 3)
        for pair in (("nan.exr", "nan.exr"), ("nan.exr", "grey.exr"), ("grey.exr", "nan.exr")):
            self.refuse(FAILED, "metrics", *pair, "--flip-map", "flip.png", matches=rf"{pair[0]} and {pair[1]}: .*no pixel that is finite in both; check")


if __name__ == "__main__":
    unittest.main()
