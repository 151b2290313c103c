#!/usr/bin/env python3
"""Tests that no output overwrites an input or another output, and that unwritable outputs are reported before
rendering."""

import json
import os
import unittest

from errors_test import FAILED, USAGE, RefusalTest
from ocio import FILM_TABLE, FILM_VIEW, is_missing
from program import SMALL, run

TINY = [*SMALL, "--spp", "1"]


class Roles(RefusalTest):
    def contents(self):
        return {p.name: p.read_bytes() for p in self.folder.iterdir() if p.is_file()}

    def refuse_pair(self, first, second, name, *arguments):
        """Expects the error to name both roles and the file, and no changes."""
        before = self.contents()
        self.refuse(USAGE, *arguments, says=[first, second, name, "choose another name"])
        self.assertEqual(self.contents(), before)

    def test_one_name_for_two_outputs(self):
        self.refuse_pair("-o", "--stats", "x.exr", "render", "cornell", *TINY, "-o", "x.exr", "--stats", "x.exr")
        self.refuse_pair("-o", "--resume", "n.png", "render", "cornell", *TINY, "-o", "n.png", "--resume", "n.png")
        self.refuse_pair("--stats", "--resume", "a", "render", "cornell", *TINY, "-o", "x.exr", "--stats", "a", "--resume", "a")
        self.refuse_pair("-o", "--stats", "f.0002.exr", "render", "cornell", *TINY, "-o", "f.####.exr", "--frames", "0-3", "--stats", "f.0002.exr")
        self.refuse_pair("-o", "--stats", "x.exr", "render", "cornell", *TINY, "-o", "x.exr", "--stats", self.folder / "x.exr")
        (self.folder / "link.json").symlink_to(self.folder / "x.exr")
        (self.folder / "x.exr").write_bytes(b"old")
        self.refuse_pair("-o", "--stats", "x.exr", "render", "cornell", *TINY, "-o", "x.exr", "--stats", "link.json")

    def test_images_that_are_measured_stay(self):
        for name in ("a.png", "b.png"):
            self.succeed("render", "cornell", *TINY, "-o", name)
        self.refuse_pair("--flip-map", "which A reads", "a.png", "metrics", "a.png", "b.png", "--flip-map", "a.png")
        self.refuse_pair("--flip-map", "which B reads", "b.png", "metrics", "a.png", "b.png", "--flip-map", "./b.png")
        os.link(self.folder / "b.png", self.folder / "hard.png")
        self.refuse_pair("--flip-map", "which B reads", "hard.png", "metrics", "a.png", "b.png", "--flip-map", "hard.png")

    def test_files_of_the_scene_are_not_overwritten(self):
        self.succeed("export", "cornell-spheres", "-o", "room.gltf")
        self.succeed("render", "cornell", *TINY, "-o", "sky.exr")
        (self.folder / "view.json").write_text(json.dumps({"scene": "room.gltf", "environment": {"map": "sky.exr"}}))
        render = ("render", "view.json", *TINY)
        for name in ("view.json", "room.gltf", "room.bin", "sky.exr"):
            with self.subTest(name=name):
                self.refuse_pair("--stats", "SCENE", name, *render, "-o", "out.exr", "--stats", name)
        self.refuse_pair("-o", "SCENE", "sky.exr", *render, "-o", "sky.exr")
        self.refuse_pair("-o", "SCENE", "room.gltf", "export", "room.gltf", "-o", "room.gltf")
        self.refuse_pair("-o", "SCENE", "room.gltf", "export", "view.json", "-o", "room.gltf")

    def write_textured_obj(self):
        self.succeed("render", "cornell", *TINY, "-o", "wood.png")
        (self.folder / "card.mtl").write_text("newmtl wood\nmap_Kd wood.png\n")
        (self.folder / "card.obj").write_text("mtllib card.mtl\nusemtl wood\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n")

    def test_textures_of_other_formats_stay(self):
        self.write_textured_obj()
        self.refuse_pair("-o", "SCENE", "wood.png", "render", "card.obj", *TINY, "-o", "wood.png")
        self.refuse_pair("--stats", "SCENE", "card.obj", "render", "card.obj", *TINY, "-o", "out.png", "--stats", "card.obj")
        self.refuse_pair("--stats", "SCENE", "card.mtl", "render", "card.obj", *TINY, "-o", "out.png", "--stats", "card.mtl")

    def test_replacements_of_missing_files_stay(self):
        self.write_textured_obj()
        scene = self.folder / "card.obj"
        scene.write_text(scene.read_text().replace("card.mtl", "nowhere.mtl"))  # card.mtl is read instead
        self.refuse_pair("--stats", "SCENE", "card.mtl", "render", "card.obj", *TINY, "-o", "out.png", "--stats", "card.mtl")

    def test_files_beside_an_exported_scene_replace_none_of_its_sources(self):
        self.succeed("export", "cornell", "-o", "b.gltf")
        (self.folder / "b.gltf").rename(self.folder / "a.gltf")
        before = self.contents()
        self.refuse(FAILED, "export", "a.gltf", "-o", "b.gltf", says=["b.bin", "would be replaced; choose another name"])
        self.assertEqual(self.contents(), before)

    def test_settings_and_light_stay(self):
        (self.folder / "s.json").write_text('{"lights": "uniform"}')
        self.refuse_pair("--stats", "--settings", "s.json", "render", "cornell", *TINY, "-o", "x.exr", "--settings", "s.json", "--stats", "s.json")
        self.succeed("render", "cornell", *TINY, "-o", "sky.exr")
        self.refuse_pair("-o", "--env", "sky.exr", "render", "cornell", *TINY, "-o", "sky.exr", "--env", "sky.exr")
        (self.folder / "e.json").write_text('{"env": "sky.exr"}')
        self.refuse_pair("-o", "--env", "sky.exr", "render", "cornell", *TINY, "-o", "sky.exr", "--settings", "e.json")

    def test_tables_of_a_view_stay(self):
        (self.folder / "luts").mkdir()
        (self.folder / "luts/film.spi1d").write_text(FILM_TABLE)
        (self.folder / "film.ocio").write_text(FILM_VIEW)
        film = ["--ocio", "film.ocio:Film"]
        render = ("render", "cornell", *TINY, *film, "-o", "x.png")
        done = run(*render, cwd=self.folder)
        if is_missing(done):
            self.skipTest(done.stderr)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.refuse_pair("--stats", "which --ocio reads", "luts/film.spi1d", *render, "--stats", "luts/film.spi1d")
        self.refuse_pair("--resume", "which --ocio reads", "luts/film.spi1d", *render, "--resume", "luts/film.spi1d")
        (self.folder / "luts/x.png").symlink_to("film.spi1d")
        self.refuse_pair("-o", "which --ocio reads", "luts/x.png", *render[:-1], "luts/x.png")
        self.assertEqual((self.folder / "luts/film.spi1d").read_text(), FILM_TABLE)
        (self.folder / "steps.txt").write_text("frames 1\nsave-view luts/film.spi1d\n")
        view = ("view", "cornell", "--smoke", "1", "--script", "steps.txt", *film)
        if "without its viewer" not in run(*view, cwd=self.folder).stderr:
            self.refuse(USAGE, *view, says=["steps.txt:2: save-view would replace luts/film.spi1d, which --ocio reads"])
        self.assertEqual((self.folder / "luts/film.spi1d").read_text(), FILM_TABLE)

    def test_compared_files_stay(self):
        self.succeed("render", "cornell", *TINY, "-o", "r.exr")
        for name in ("a.json", "a.csv"):
            os.link(self.folder / "r.exr", self.folder / name)
        compare = ("compare", "cornell", *SMALL, "--cache-dir", "cache", "-o", "a.html")
        self.refuse_pair("-o", "--reference", "a.json", *compare, "--reference", "r.exr")
        self.refuse_pair("-o", "--image", "a.json", *compare, "--image", "r.exr")
        self.refuse_pair("-o", "--env", "a.json", *compare, "--env", "r.exr")

    def test_roles_that_may_share_a_file(self):
        self.succeed("render", "cornell", *TINY, "-o", "a.exr", "--resume", "a.ckpt", "--stats", "/dev/null")
        self.succeed("render", "cornell", *TINY, "-o", "a.exr", "--resume", "a.ckpt", "--stats", "a.json")
        self.succeed("render", "cornell", "-o", "b.exr", "--settings", "a.exr")
        self.succeed("render", "cornell", *TINY, "-o", "f.####.exr", "--frames", "0-1", "--stats", "f.json")
        self.succeed("metrics", "a.exr", "a.exr", "--flip-map", "map.png")
        self.assertIn('"scene"', self.succeed("render", "cornell", *TINY, "-o", "a.exr", "--stats", "/dev/stdout").stdout)


class Unwritable(RefusalTest):
    """Every output of every command, before rendering."""

    def outputs(self, name):
        """Commands with one output of this name, whose extension suits all."""
        render = ["render", "cornell", "--width", "4096", "--height", "4096", "--spp", "100000"]
        yield from ([*render, "-o", name], [*render, "-o", "x.exr", "--stats", name], [*render, "-o", "x.exr", "--resume", name])
        yield [*render, "-o", name.replace(".exr", ".####.exr"), "--frames", "0-3"]
        yield ["metrics", "x.exr", "x.exr", "--flip-map", name]
        yield ["export", "cornell", "-o", name.replace(".exr", ".glb")]
        yield ["compare", "cornell", "--reference-spp", "100000", "-o", name.replace(".exr", ".html"), "--cache-dir", "cache"]
        yield ["experiment", "run", "guide-cost", "-o", name.replace(".exr", "")]
        yield ["survey", "--scenes", "cornell", "-o", name.replace(".exr", "")]
        yield ["man", "-o", name.replace(".exr", "")]
        yield ["view", "cornell", "--smoke", "1", "--screenshot", name.replace(".exr", ".png")]

    def refuse_each_output(self, name, matches):
        for command in self.outputs(name):
            with self.subTest(command=command[:1] + command[-2:]):
                if command[0] == "view" and "without its viewer" in run(*command, cwd=self.folder).stderr:
                    continue
                self.refuse(USAGE, *command, matches=matches)

    def test_long_names(self):
        self.refuse_each_output("a" * 260 + ".exr", "has 2[67]. bytes, but may have 255 at most|File name too long")

    def test_names_that_become_long(self):
        name = "a" * 246 + ".#.exr"
        self.refuse(USAGE, "render", "cornell", *TINY, "-o", name, "--frames", "0-99999", matches="has 256 bytes")

    def test_long_paths(self):
        self.refuse_each_output("a/" * 2050 + "b.exr", "but may have 4095 at most|File name too long|cannot be created")

    def test_missing_folders(self):
        for command in self.outputs("missing/x.exr"):
            if command[0] in ("experiment", "survey", "man"):
                continue  # they create their folders
            with self.subTest(command=command[:1] + command[-2:]):
                if command[0] == "view" and "without its viewer" in run(*command, cwd=self.folder).stderr:
                    continue
                self.refuse(USAGE, *command, says=["missing does not exist; create it first"])

    def test_folders_in_the_way_of_frames(self):
        for number in ("0000", "0001", "0002"):
            with self.subTest(number=number):
                folder = self.folder / f"f.{number}.exr"
                folder.mkdir()
                self.refuse(USAGE, "render", "cornell", *TINY, "-o", "f.####.exr", "--frames", "0-2", says=[f"f.{number}.exr is a folder; name a file in it, or choose another name"])
                folder.rmdir()

    def test_folders_that_take_no_file(self):
        self.refuse_each_output("/proc/x.exr", "cannot be written|cannot be created")

    def test_a_cache_that_takes_no_file(self):
        self.refuse(FAILED, "compare", "cornell", *TINY, "-o", "page.html", "--cache-dir", "/proc", matches="/proc/references")

    def test_files_of_a_script(self):
        (self.folder / "steps.txt").write_text("frames 1\nsave missing/a.png\n")
        done = run("view", "cornell", "--smoke", "1", "--script", "steps.txt", cwd=self.folder)
        if "without its viewer" in done.stderr:
            self.skipTest("no viewer")
        self.assertIn("steps.txt:2: save: missing/a.png: the folder missing does not exist", done.stderr)
        script = "frames 1\nsave-view steps.txt\n"
        (self.folder / "steps.txt").write_text(script)
        self.refuse(USAGE, "view", "cornell", "--smoke", "1", "--script", "steps.txt", says=["steps.txt:2: save-view would replace steps.txt, which --script reads"])
        self.assertEqual((self.folder / "steps.txt").read_text(), script)
        self.succeed("export", "cornell-spheres", "-o", "room.gltf")
        self.succeed("render", "cornell", *TINY, "-o", "sky.exr")
        for steps, reader in (("drop room.gltf\nsave-view room.gltf", "drop"), ("set env sky.exr\nsave sky.exr", "set"), ("set-b env sky.exr\nscreenshot sky.exr", "set-b")):
            with self.subTest(steps=steps):
                (self.folder / "steps.txt").write_text(steps + "\n")
                self.refuse(USAGE, "view", "cornell", "--smoke", "1", "--script", "steps.txt", says=["steps.txt:2: ", " would replace ", f"which steps.txt:1: {reader} reads"])
        (self.folder / "steps.txt").write_text("frames 1\nsave-view sky.exr\ndrop sky.exr\n")
        self.assertNotIn("would replace", run("view", "cornell", "--smoke", "1", "--script", "steps.txt", cwd=self.folder).stderr)
        (self.folder / "steps.txt").write_text("save a.png\nsave ./a.png\n")
        self.refuse(USAGE, "view", "cornell", "--smoke", "1", "--script", "steps.txt", says=["steps.txt:1: save and steps.txt:2: save would write the same file"])


if __name__ == "__main__":
    unittest.main()
