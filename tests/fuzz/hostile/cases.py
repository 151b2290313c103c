"""Input of a trial: arguments and the program's input folder, generated from a random.Random."""

import dataclasses
import os

import command_lines
import outputs
import images
import references
import scenes
from damage import damage
from trial_case import SMALL, Case

TECHNIQUES = [
    [], [], [], [], ["--lights", "light-tree"], ["--lights", "vlc", "--guide", "cdq"], ["--lights", "static-lists", "--static-lists.rays", "64"], ["--cache", "psf"],
    ["--cache", "apsf+apg"], ["--cache", "sharc"], ["--reuse", "restir-gi"], ["--reuse", "restir-pt"], ["--estimator", "bdpt"], ["--estimator", "light"], ["--history", "reproject", "--denoise", "svgf"], ["--denoise", "bmfr"],
    ["--allocation", "adaptive", "--spp", "8"], ["--texture-filter", "encoded"], ["--aov", "albedo,normal,depth,motion"], ["--env", "1,1,1"], ["--scene-time", "0.5"],
]
IMAGES = ["out.exr", "out.exr", "out.hdr", "out.png", "out.jpg", "out.tga"]


def render(scene, rng, *more):
    """Renders with a random technique."""
    technique = rng.choice(TECHNIQUES)
    image = "made/" + ("out.exr" if "--aov" in technique else rng.choice(IMAGES))
    arguments = ["render", scene, *SMALL, *technique, *more]
    required = [image]
    if rng.random() < 0.1:
        arguments += ["--stats", "made/stats.json"]
        required.append("made/stats.json")
    if rng.random() < 0.1:
        arguments += ["--frames", "0-1"]
        stem, extension = os.path.splitext(image)
        image, required[:1] = f"{stem}.####{extension}", [f"{stem}.0000{extension}", f"{stem}.0001{extension}"]
    return Case("", [*arguments, "-o", image, "-q"], required=required)


def use_scene(scene, rng):
    """Renders, exports or describes the scene file."""
    chance = rng.random()
    if chance < 0.65:
        return render(scene, rng)
    if chance < 0.85:
        file = "made/" + rng.choice(("b.gltf", "b.glb", "b.pbrt"))
        return Case("", ["export", scene, "-o", file, "-q"], required=[file])
    return Case("", ["info", scene, "-q", *rng.choice(([], ["--json"]))])


def damaged_scene(kind, files, rng):
    """A scene with one file, usually the main one, damaged once or twice."""
    files = dict(files)
    names = list(files)
    victim = names[0] if rng.random() < 0.75 else rng.choice(names)
    for _ in range(rng.choice((1, 1, 1, 2))):
        files[victim] = damage(victim, files[victim], rng)
    return dataclasses.replace(use_scene(names[0], rng), kind=kind, files=files)


def some_images():
    return {
        "a.png": [images.png(), images.png(depth=16, channels=3), images.png(channels=1), images.palette_png()],
        "a.jpg": [images.jpeg(), images.jpeg(1)], "a.bmp": [images.bmp()], "a.tga": [images.tga(), images.tga(packed=True)],
        "a.hdr": [images.hdr(), images.hdr(packed=False)],
        "a.exr": [images.exr(), images.exr(compress=False), images.exr(half=True), images.exr(tiled=True), images.exr(channels=("A", "B", "G", "R", "albedo.R"))],
    }


def sealed(checkpoint):
    """Appends the checksum of the damaged bytes (FNV-1a, 64 bits), so that the reader accepts them."""
    value = 0xcbf29ce484222325
    for byte in checkpoint[:-8]:
        value = (value ^ byte) * 0x100000001b3 & 0xffffffffffffffff
    return checkpoint[:-8] + value.to_bytes(8, "little")


class Maker:
    """Makes cases. `products` are files written by the program, `helps` its help texts."""

    def __init__(self, products, helps):
        self.products = products
        self.scenes = scenes.all_scenes()
        self.images = some_images()
        self.lines = command_lines.CommandLines(helps)
        weights = {"gltf": 9, "glb": 6, "relume json": 6, "mitsuba": 8, "obj": 4, "ply": 4, "pbrt": 6, "stl": 2, "off": 2, "dae": 3, "fbx": 3, "3ds": 2}
        makers = {self.texture: 6, self.environment: 5, self.settings: 5, self.settings_exr: 3, self.checkpoint: 5, self.metrics: 6, self.compare: 2,
                  self.command_line: 14, self.output: 9, self.reference: 6}
        # Starts with every kind, so that a short trial covers all.
        everything = [(self.scene(kind), weight) for kind, weight in weights.items()] + list(makers.items())
        self.order = [make for round_ in range(max(weight for _, weight in everything)) for make, weight in everything if weight > round_]

    def make(self, number, rng):
        return self.order[number % len(self.order)](rng)

    def scene(self, kind):
        return lambda rng: damaged_scene(kind, rng.choice(self.scenes[kind]), rng)

    def damaged_image(self, rng, names):
        name = rng.choice(names)
        return name, damage(name, rng.choice(self.images[name]), rng)

    def texture(self, rng):
        name, data = self.damaged_image(rng, list(self.images))
        if name in ("a.png", "a.jpg") and rng.random() < 0.5:
            files = {"a.gltf": scenes.gltf({"uri": name}).text(), name: data}
        else:
            files = scenes.obj(name, data)
        return dataclasses.replace(use_scene(next(iter(files)), rng), kind="texture", files=files)

    def environment(self, rng):
        name, data = self.damaged_image(rng, ["a.hdr", "a.exr"])
        if rng.random() < 0.6:
            case = render(rng.choice(("cornell", "furnace")), rng)
            return dataclasses.replace(case, kind="environment", files={name: data}, arguments=case.arguments + ["--env", name])
        scene = scenes.relume_json("builtin:furnace", "white", "sphere", {"map": name, "rotation_deg": 5})
        files = {"a.json": scene, name: data}
        return dataclasses.replace(use_scene("a.json", rng), kind="environment", files=files)

    def settings(self, rng):
        name = rng.choice(("all.json", "few.json"))
        few = b'{"max-bounces": 3, "cache": "psf", "psf": {"cell-size": 4, "jitter": false}, "lights": "light-tree", "exposure": 1}'
        data = damage(name, self.products["all.json"] if name == "all.json" else few, rng)
        case = render("cornell", rng, "--settings", name)
        return dataclasses.replace(case, kind="settings", files={name: data})

    def settings_exr(self, rng):
        text = rng.choice(('{"max-bounces": 3}', self.products["all.json"].decode(), "{}", "[", '{"max-bounces": 1e308}'))
        data = images.exr(texts={"relume.settings": text, "relume.seed": "1", "relume.version": "1"})
        data = rng.choice((self.products["out.exr"], data))
        data = data if rng.random() < 0.1 else damage("a.exr", data, rng)
        if rng.random() < 0.3:
            return Case("settings exr", ["info", "a.exr", "--json"], {"a.exr": data})
        case = render("cornell", rng, "--settings", "a.exr")
        return dataclasses.replace(case, kind="settings exr", files={"a.exr": data})

    def checkpoint(self, rng):
        name = rng.choice([name for name in self.products if name.endswith(".ckpt")])
        data = self.products[name]
        settings = data.rindex(b"}") + 1 if rng.random() < 0.5 else 0  # unchanged, half of the time
        for _ in range(rng.choice((1, 1, 3))):
            data = data[:settings] + damage(name, data[settings:], rng)
        if rng.random() < 0.6:
            data = sealed(data)
        arguments = [*command_lines.CHECKPOINTS[name], "--spp", "4", "--resume", name, "-o", "made/out.exr", "-q"]
        return Case("checkpoint", arguments, {name: data}, required=["made/out.exr"], may_change=[name])

    def metrics(self, rng):
        first, data = self.damaged_image(rng, list(self.images))
        files = {first: data, "b.exr": images.exr()}
        pair = [first, rng.choice(("b.exr", first))]
        rng.shuffle(pair)
        arguments, required = ["metrics", *pair], []
        if rng.random() < 0.3:
            arguments += ["--flip-map", "made/flip.png"]
            required.append("made/flip.png")
        return Case("metrics", [*arguments, *rng.choice(([], ["--json"], ["--hdr-flip"]))], files, required=required)

    def compare(self, rng):
        name, data = self.damaged_image(rng, ["a.exr", "a.hdr", "a.png"])
        few = damage("few.json", b'{"max-bounces": 3, "lights": "uniform"}', rng)
        which = rng.choice((["--image", f"x={name}"], ["--reference", name], ["--techniques", "default,few.json"]))
        arguments = ["compare", "cornell", *SMALL, "--repeat", "1", "--reference-spp", "2", "--cache-dir", "cache", "-o", "made/page", "-q"]
        return Case("compare", arguments + which, {name: data, "few.json": few}, required=["made/page/compare.html"])

    def command_line(self, rng):
        return self.lines.make(rng)

    def output(self, rng):
        return outputs.make(rng)

    def reference(self, rng):
        case_files = references.make(rng)
        return dataclasses.replace(use_scene(case_files.scene, rng), kind="reference", files=case_files.files, links=case_files.links)
