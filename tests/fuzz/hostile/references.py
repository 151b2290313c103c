"""Files that reference themselves, each other in cycles, far too much data, or special files."""

import dataclasses
import json

import images
import scenes

LONG = "n" * 300  # more than a file name may have


@dataclasses.dataclass
class Files:
    scene: str
    files: dict
    links: dict = dataclasses.field(default_factory=dict)


def json_circle(rng):
    length = rng.choice((1, 2, 3))
    files = {f"{i}.json": json.dumps({"scene": f"{(i + 1) % length}.json"}).encode() for i in range(length)}
    return Files("0.json", files)


def json_to_odd_file(rng):
    target = rng.choice((".", "..", "/dev/null", "/dev/zero", "builtin:", "builtin:cornel", "", "a.json", "./a.json", "a.png", "b.ply", LONG))
    files = {"a.json": json.dumps({"scene": target}).encode(), "a.png": images.png()}
    return Files("a.json", files, {"b.ply": "/dev/null"})


def gltf_nodes(rng):
    """Children in cycles, with two parents, in chains, or doubled at every level."""
    file = scenes.Gltf()
    positions = file.accessor([0, 0, 0, 1, 0, 0, 0, 1, 0], "VEC3")
    file.add("meshes", {"primitives": [{"attributes": {"POSITION": positions}}]})
    which = rng.randrange(6)
    count = {2: 20000, 3: 40}.get(which, 3)
    for i in range(count):
        file.node(root=i == 0, mesh=0)
    nodes = file.doc["nodes"]
    if which == 0:
        nodes[0]["children"] = [0]
    elif which == 1:
        nodes[0]["children"], nodes[1]["children"] = [1], [0]
    else:
        copies = 2 if which == 3 else 1
        for i in range(count - 1):
            nodes[i]["children"] = [i + 1] * copies
    if which == 4:
        file.doc["scenes"][0]["nodes"] = [0, 1, 2, 0]
    if which == 5:
        file.doc["scenes"][0]["nodes"] = list(range(3)) * 1000
    return Files("a.gltf", {"a.gltf": file.text()})


def gltf_to_odd_file(rng):
    target = rng.choice((".", "a.gltf", "/dev/zero", "/dev/null", "../../outside.png", "a%00b", "data:,", "data:application/octet-stream;base64," + "A" * 100, "http://127.0.0.1/a", "%", "b", LONG))
    file = scenes.gltf({"uri": target} if rng.random() < 0.5 else None)
    text = file.text(target) if rng.random() < 0.5 else file.text()
    return Files("a.gltf", {"a.gltf": text}, {"b": "b"})


def gltf_members(rng):
    """Members that reference each other, or missing objects."""
    file = scenes.gltf()
    doc = file.doc
    wrong = rng.choice((-1, 0, 1, 99, 1 << 31, (1 << 63) - 1))
    which = rng.randrange(8)
    if which == 0:
        doc["textures"][0]["source"] = wrong
    elif which == 1:
        doc["skins"][0]["joints"] = [wrong] * 3
    elif which == 2:
        doc["animations"][0]["samplers"][0]["output"] = doc["animations"][0]["samplers"][0]["input"]
    elif which == 3:
        doc["animations"][0]["channels"] = doc["animations"][0]["channels"][:1] * 500
    elif which == 4:
        for accessor in doc["accessors"]:
            accessor["bufferView"] = 0
    elif which == 5:
        doc["accessors"][1]["count"] = rng.choice((1 << 31, 1 << 40, (1 << 63) - 1, 0))
    elif which == 6:
        sparse = next(a for a in doc["accessors"] if "sparse" in a)
        sparse["sparse"]["count"] = rng.choice((0, 5, 1 << 31))
        sparse.pop("bufferView")
        sparse["count"] = rng.choice((4, 1 << 20, 1 << 28))
    else:
        doc["scene"] = wrong
    return Files("a.gltf", {"a.gltf": file.text()})


def obj_library(rng):
    target = rng.choice((b"a.obj", b".", b"/dev/zero", b"/dev/null", b"b.mtl"))
    files = scenes.obj("a.png", images.png())
    files["a.obj"] = files["a.obj"].replace(b"a.mtl", target)
    texture = rng.choice((b"a.obj", b".", b"/dev/zero", b"*0", b"../../outside.png"))
    files["a.mtl"] = files["a.mtl"].replace(b"a.png", texture)
    return Files("a.obj", files, {"b.mtl": "b.mtl"})


def dae_nodes(rng):
    """Nodes that instantiate themselves, or double at every level."""
    if rng.random() < 0.5:
        inner = b'<node id="q"><instance_node url="#q"/></node>'
    else:
        depth = rng.choice((3, 12, 40))
        levels = "".join(f'<node id="q{i or ""}"><instance_node url="#q{i + 1}"/><instance_node url="#q{i + 1}"/></node>' for i in range(depth))
        inner = (levels + f'<node id="q{depth}"><instance_geometry url="#g"/></node>').encode()
    data = scenes.DAE.replace(b'<node id="q"><instance_geometry url="#g"/></node>', inner)
    return Files("a.dae", {"a.dae": data})


def fbx_connections(rng):
    extra = rng.choice((b' C: "OO",2,2\n', b' C: "OO",0,2\n', b' C: "OO",1,1\n C: "OO",2,1\n', b' C: "OO",2,99\n', b' C: "OO",1,2\n' * 1000))
    return Files("a.fbx", {"a.fbx": scenes.FBX.replace(b"Connections: {\n", b"Connections: {\n" + extra)})


def mitsuba_includes(rng):
    """Files that include each other in cycles or doubled at every level, parameters and merged shapes that double, cycles of
    references, and paths that leave the folder."""
    def scene(inner):
        return f'<scene version="3.0.0">{inner}<shape type="cube"/></scene>'.encode()

    which = rng.randrange(6)
    if which == 0:
        length = rng.choice((1, 2, 20))
        return Files("0.xml", {f"{i}.xml": scene(f'<include filename="{(i + 1) % length}.xml"/>') for i in range(length)})
    if which == 1:
        return Files("0.xml", {f"{i}.xml": scene(2 * f'<include filename="{i + 1}.xml"/>' if i < 13 else "") for i in range(14)})
    if which == 2:
        laughs = "".join(f'<default name="a{i + 1}" value="$a{i} $a{i}"/>' for i in range(60))
        return Files("a.xml", {"a.xml": scene('<default name="a0" value="ha"/>' + laughs)})
    if which == 3:
        length = rng.choice((1, 3, 5000))
        return Files("a.xml", {"a.xml": scene("".join(f'<bsdf type="twosided" id="{i}"><ref id="{(i + 1) % length}"/></bsdf>' for i in range(length)))})
    if which == 4:
        merges = "".join(f'<shape type="merge" id="{i}"><ref id="{i + 1}"/><ref id="{i + 1}"/></shape>' for i in range(30))
        return Files("a.xml", {"a.xml": scene(merges + rng.choice(('<shape type="cube" id="30"/>', '<shape type="merge" id="30"/>')))})
    target = rng.choice((".", "..", "a.xml", "/dev/zero", "/dev/null", "../../outside.png", "b.ply", "", LONG))
    kind = rng.choice(('<shape type="obj">', '<shape type="ply">', '<shape type="serialized">', '<emitter type="envmap">', '<texture type="bitmap">'))
    file = f'{kind}<string name="filename" value="{target}"/></{kind[1:].split()[0]}>'
    if "texture" in kind:
        file = f'<shape type="sphere"><bsdf type="diffuse">{file.replace("<texture", "<texture name=" + chr(34) + "reflectance" + chr(34))}</bsdf></shape>'
    return Files("a.xml", {"a.xml": scene(file if rng.random() < 0.7 else f'<include filename="{target}"/>')}, {"b.ply": "b.ply"})


def no_file(rng):
    name = "a" + rng.choice((".gltf", ".glb", ".json", ".obj", ".ply", ".stl", ".fbx", ".dae", ".3ds", ".off", ".xml", ".exr", ".png", ""))
    return Files(name, {}, {name: rng.choice((".", "/dev/null", name, "nowhere", "/dev/full", "/proc/self/mem"))})


def endless_device(rng):
    name = "a" + rng.choice((".gltf", ".json", ".ply", ".obj"))
    return Files(name, {}, {name: "/dev/zero"})


# Rare, since endless devices cost a gigabyte each.
MAKERS = 6 * [json_circle, json_to_odd_file, gltf_nodes, gltf_nodes, gltf_to_odd_file, gltf_members, gltf_members, obj_library, dae_nodes, fbx_connections, mitsuba_includes, mitsuba_includes, no_file] + [endless_device]


def make(rng):
    return rng.choice(MAKERS)(rng)
