#!/usr/bin/env python3
"""Bad input: one clear sentence, a non-zero exit code, and nothing left behind."""

import os
import subprocess
import unittest

from program import PROGRAM, SMALL, ProgramTest, run

FAILED, USAGE = 1, 2


class Errors(ProgramTest):
    def refuse(self, code, *arguments, says=()):
        """Expects failure with one sentence that has every text of `says`, and no new file."""
        before = self.files()
        done = run(*arguments, cwd=self.folder)
        self.assertEqual(done.returncode, code, done.stderr)
        lines = done.stderr.splitlines()
        self.assertEqual(len(lines), 1, done.stderr)
        self.assertTrue(lines[0].startswith("relume: "), lines[0])
        for text in says:
            self.assertIn(text, lines[0])
        self.assertEqual(done.stdout, "")
        self.assertEqual(self.files(), before)

    def render(self, *arguments):
        return ("render", "cornell", *SMALL, "--spp", "1", *arguments)

    def test_unknown_scene(self):
        self.refuse(FAILED, "render", "cornel", "-o", "out.exr", *SMALL, says=["cornel", "cornell"])

    def test_missing_file(self):
        self.refuse(FAILED, "render", "no/such.glb", "-o", "out.exr", *SMALL, says=["no/such.glb"])

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
        self.refuse(USAGE, *self.render("-o", "out.exr", "--exposure", "nan"), says=["--exposure"])
        self.refuse(USAGE, *self.render("-o", "out.exr", "--time", "soon"), says=["--time"])

    def test_timing_of_what_is_compared_by_pictures(self):
        for other in (("--budget", "1s"), ("-o", "out"), ("--reference", "a.exr")):
            self.refuse(USAGE, "compare", "cornell", *SMALL, "--timing", "4", *other, says=["--timing", "leave"])

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

    def test_damaged_checkpoint(self):
        (self.folder / "a.ckpt").write_bytes(b"no checkpoint")
        self.refuse(FAILED, *self.render("-o", "out.exr", "--resume", "a.ckpt", "--quiet"), says=["a.ckpt"])

    def test_checkpoint_of_other_settings(self):
        self.succeed(*self.render("-o", "a.exr", "--resume", "a.ckpt", "--quiet"))
        (self.folder / "a.exr").unlink()
        self.refuse(FAILED, *self.render("-o", "out.exr", "--resume", "a.ckpt", "--quiet", "--seed", "3"), says=["a.ckpt", "settings"])

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


if __name__ == "__main__":
    unittest.main()
