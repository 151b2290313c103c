"""Cases with unwritable outputs and difficult file names."""

import os

import scenes
from trial_case import SMALL, Case

LONG = "n" * 300
ODD_NAMES = [
    LONG + ".exr", "n" * 251 + ".exr", "n" * 252 + ".exr", "é" * 125 + ".exr", "-x.exr", " .exr", ".exr", "a\nb.exr", "a\x1b[31m.exr", b"\xff\xfe.exr", "%s%n.exr", "a.EXR",
    "####.exr", "%04d.exr", "a..exr", "a.exr.", "a.exr ", "a.exr/", "nowhere/a.exr", "../made/a.exr", "a.gif", "a", "", ".", "..", "a.png.exr", "a:b.exr", "*.exr", "{}.exr",
]
FRAME_NAMES = ["a.####.exr", "%04d.exr", "%d.exr", "%s.exr", "%n.exr", "%1000000d.exr", "%99999999999d.exr", "a.%04d.%04d.exr", "#.exr", "#" * 200 + ".exr", "a.####.png",
               "####/a.exr", "%%.exr", "%", "a.exr", "a.y4m"]


def render(*more):
    return ["render", "cornell", *SMALL, "-q", *more]


def below_made(name):
    return b"made/" + name if isinstance(name, bytes) else "made/" + name


def odd_name(rng):
    return Case("output", render("-o", below_made(rng.choice(ODD_NAMES))))


def odd_frames(rng):
    name = rng.choice(FRAME_NAMES)
    return Case("output", render("--frames", rng.choice(("0-1", "7", "999999-1000000")), "-o", below_made(name)))


def odd_file_of_another_kind(rng):
    name = rng.choice([LONG, "n" * 255, "s." + "x" * 250, ".", "nowhere/s", "made", "-"])
    flag = rng.choice(("--stats", "--resume"))
    return Case("output", render(flag, below_made(name), "-o", "made/a.exr"))


def folder_in_the_way(rng):
    file, arguments = rng.choice((("made/a.exr", ["-o", "made/a.exr"]), ("made/a.png", ["-o", "made/a.png"]), ("made/a.0001.exr", ["-o", "made/a.####.exr", "--frames", "0-2"])))
    return Case("output", render(*arguments), folders=[file])


def file_in_the_way(rng):
    return Case("output", render("-o", "plain/a.exr", *rng.choice(([], ["--stats", "plain/s.json"], ["--resume", "plain/a.ckpt"]))), {"plain": b"text"})


def full_device(rng):
    which = rng.randrange(5)
    if which == 0:
        return Case("output", rng.choice((["scenes"], ["settings", "--json"], ["info", "cornell"], ["devices"], ["man", "render"], ["completion", "zsh"], ["--help"], ["--version"],
                                          ["render", "--help"])), stdout="/dev/full")
    name = rng.choice(("full.exr", "full.hdr", "full.png", "full.jpg", "full.tga"))
    if which == 1:
        return Case("output", render("-o", name), links={name: "/dev/full"})
    if which == 2:
        return Case("output", render("-o", "made/a.exr", rng.choice(("--stats", "--resume")), "full"), links={"full": "/dev/full"}, may_stay=["made/a.exr"])
    if which == 3:
        file = rng.choice(("full.glb", "full.gltf"))
        return Case("output", ["export", "cornell", "-q", "-o", file], links={file: "/dev/full"})
    return Case("output", ["export", "cornell", "-q", "-o", "a.gltf"], links={"a.bin": "/dev/full"})


def link(rng):
    """A link to a missing file, to itself, to a folder, to a missing folder, or to a device."""
    target = rng.choice(("made/new.exr", "a.exr", "made", "nowhere/a.exr", "/dev/null"))
    return Case("output", render("-o", "a.exr"), links={"a.exr": target}, may_change=["a.exr"])


def locked_folder(rng):
    if os.geteuid() == 0:  # root ignores permissions
        return odd_name(rng)
    return Case("output", rng.choice((render("-o", "locked/a.exr"), ["export", "cornell", "-q", "-o", "locked/a.gltf"])), folders=["locked"], locked="locked")


def same_name_twice(rng):
    """One name for two outputs, which must be refused. A flag that is given twice, or numbered frames, are no such pair."""
    refused = [
        render("-o", "made/a.exr", "--stats", "made/a.exr"), render("-o", "made/a.exr", "--resume", "made/a.exr"), render("-o", "made/a.exr", "--resume", "made/a", "--stats", "made/a"),
        render("-o", "made/a.exr", "--stats", "made/../made/a.exr"), render("-o", "made/a.####.exr", "--frames", "0-2", "--stats", "made/a.0001.exr"),
    ]
    accepted = [render("-o", "made/a.exr", "-o", "made/a.exr"), render("-o", "made/a.exr", "--frames", "0-1"), ["export", "cornell", "-q", "-o", "made/a.glb", "-o", "made/a.gltf"]]
    arguments = rng.choice(refused + accepted)
    return Case("output", arguments, refused=arguments in refused)


def over_input(rng):
    """An output that would replace an input, under its name or through a link, which must be refused."""
    rich = scenes.gltf()
    image = scenes.images.exr(texts={"relume.settings": '{"max-bounces": 2}'})
    cases = [
        (["export", "a.gltf", "-q", "-o", "a.gltf"], {"a.gltf": rich.text("a.bin"), "a.bin": rich.data}),
        (["export", "a.glb", "-q", "-o", "a.glb"], {"a.glb": rich.glb()}),
        (render("--settings", "a.exr", "-o", "a.exr"), {"a.exr": image}),
        (render("--settings", "a.exr", "-o", "link.exr"), {"a.exr": image}),
        (render("--env", "a.exr", "-o", "a.exr"), {"a.exr": image}),
        (["render", "a.glb", *SMALL, "-q", "--stats", "a.glb", "-o", "made/a.exr"], {"a.glb": rich.glb()}),
        (["render", "a.gltf", *SMALL, "-q", "--stats", "a.bin", "-o", "made/a.exr"], {"a.gltf": rich.text("a.bin"), "a.bin": rich.data}),
        (["metrics", "a.png", "a.png", "--flip-map", "a.png"], {"a.png": scenes.images.png()}),
        (render("--settings", "a.json", "--stats", "a.json", "-o", "made/a.exr"), {"a.json": b'{"max-bounces": 2}'}),
    ]
    arguments, files = rng.choice(cases)
    return Case("output", arguments, files, links={"link.exr": "a.exr"} if "link.exr" in arguments else {}, refused=True)


def beside_input(rng):
    """Files of an exported scene beside those that it is read from."""
    texture = rng.choice(("a.png", "a.texture0.png"))
    return Case("output", ["export", "a.obj", "-q", "-o", "a.gltf"], scenes.obj(texture, scenes.images.png()), may_change=["a.gltf", "a.bin", "a.texture*.png"])


MAKERS = [odd_name, odd_name, odd_frames, odd_file_of_another_kind, folder_in_the_way, file_in_the_way, full_device, link, locked_folder, same_name_twice, over_input, beside_input]


def make(rng):
    return rng.choice(MAKERS)(rng)
