"""Small valid scenes of every supported format. Each is a dictionary of files; the first is the scene."""

import base64
import gzip
import json
import struct
import zlib

import images

ARRAY, INDICES = 34962, 34963
U8, U16, U32, F32 = 5121, 5123, 5125, 5126


class Gltf:
    """A document and its buffer."""

    def __init__(self):
        self.data = b""
        self.doc = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": []}

    def add(self, member, value):
        self.doc.setdefault(member, []).append(value)
        return len(self.doc[member]) - 1

    def view(self, data, **more):
        self.data += bytes(-len(self.data) % 4)
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data), **more}
        self.data += data
        return self.add("bufferViews", view)

    def accessor(self, values, shape="SCALAR", component=F32, **more):
        code = {U8: "B", U16: "H", U32: "I", F32: "f"}[component]
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}[shape]
        view = self.view(struct.pack(f"<{len(values)}{code}", *values))
        return self.add("accessors", {"bufferView": view, "componentType": component, "count": len(values) // width, "type": shape, **more})

    def node(self, root=True, **members):
        node = self.add("nodes", members)
        if root:
            self.doc["scenes"][0]["nodes"].append(node)
        return node

    def text(self, uri=None):
        uri = uri or "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
        return json.dumps({**self.doc, "buffers": [{"byteLength": len(self.data), "uri": uri}]}).encode()

    def glb(self):
        text = json.dumps({**self.doc, "buffers": [{"byteLength": len(self.data)}]}).encode()
        text += b" " * (-len(text) % 4)
        data = self.data + bytes(-len(self.data) % 4)
        head = struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + len(data))
        return head + struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data


def material(texture):
    moved = {**texture, "extensions": {"KHR_texture_transform": {"offset": [0.1, 0.2], "rotation": 0.3, "scale": [4, 5]}}}
    return {
        "name": "paint", "alphaMode": "MASK", "alphaCutoff": 0.3, "doubleSided": True, "emissiveFactor": [1, 1, 1], "emissiveTexture": texture,
        "pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.7, 0.6, 1], "baseColorTexture": moved, "metallicFactor": 0.2,
                                 "roughnessFactor": 0.5, "metallicRoughnessTexture": texture},
        "normalTexture": {**texture, "scale": 0.5},
        "extensions": {
            "KHR_materials_emissive_strength": {"emissiveStrength": 5},
            "KHR_materials_transmission": {"transmissionFactor": 0.5, "transmissionTexture": texture},
            "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [0.5, 0.5, 1]},
            "KHR_materials_ior": {"ior": 1.4}, "KHR_materials_dispersion": {"dispersion": 0.4},
            "KHR_materials_specular": {"specularFactor": 0.5, "specularTexture": texture},
            "KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatRoughnessTexture": texture, "clearcoatNormalTexture": texture},
            "KHR_materials_anisotropy": {"anisotropyStrength": 0.5, "anisotropyRotation": 1, "anisotropyTexture": texture},
            "KHR_materials_sheen": {"sheenColorFactor": [1, 0.5, 0.2], "sheenRoughnessFactor": 0.5, "sheenRoughnessTexture": texture},
            "KHR_materials_iridescence": {"iridescenceFactor": 1, "iridescenceIor": 1.4, "iridescenceThicknessTexture": texture},
            "KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.5, "diffuseTransmissionColorTexture": texture},
        },
        "extras": {"relume": {"microfacet_model": "beckmann"}},
    }


def mesh(file):
    positions = file.accessor([0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0], "VEC3", min=[0, 0, 0], max=[1, 1, 0])
    patched = file.view(struct.pack("<2H", 1, 3))
    patch = file.view(struct.pack("<6f", 1, 0, 0.1, 1, 1, 0.1))
    file.doc["accessors"][positions]["sparse"] = {"count": 2, "indices": {"bufferView": patched, "componentType": U16}, "values": {"bufferView": patch}}
    attributes = {
        "POSITION": positions, "NORMAL": file.accessor([0, 0, 1] * 4, "VEC3"),
        "TEXCOORD_0": file.accessor([0, 0, 65535, 0, 0, 65535, 65535, 65535], "VEC2", U16, normalized=True),
        "COLOR_0": file.accessor([200] * 16, "VEC4", U8, normalized=True), "TANGENT": file.accessor([1, 0, 0, 1] * 4, "VEC4"),
        "JOINTS_0": file.accessor([0] * 16, "VEC4", U8), "WEIGHTS_0": file.accessor([1, 0, 0, 0] * 4, "VEC4"),
    }
    indices = file.accessor([0, 1, 2, 3], component=U16)
    target = {"POSITION": file.accessor([0, 0, 1] * 4, "VEC3")}
    strip = {"attributes": attributes, "indices": indices, "mode": 5, "material": 0, "targets": [target]}
    plain = {"attributes": {"POSITION": positions}, "indices": file.accessor([0, 1, 2, 2, 1, 3], component=U32)}
    return file.add("meshes", {"name": "patch", "primitives": [strip, plain], "weights": [0.5]})


def animate(file, node, camera):
    times = file.accessor([0, 0.5, 1])
    turns = file.accessor([0, 0, 0, 1, 0, 0.7071, 0, 0.7071, 0, 1, 0, 0], "VEC4")
    moves = file.accessor([0, 0, 5, 1, 0, 5, 2, 0, 5], "VEC3")
    tangents = file.accessor([0.1] * 27, "VEC3")
    file.add("animations", {
        "name": "turn",
        "samplers": [{"input": times, "output": turns, "interpolation": "LINEAR"}, {"input": times, "output": moves, "interpolation": "STEP"},
                     {"input": times, "output": tangents, "interpolation": "CUBICSPLINE"}],
        "channels": [{"sampler": 0, "target": {"node": node, "path": "rotation"}}, {"sampler": 1, "target": {"node": camera, "path": "translation"}},
                     {"sampler": 2, "target": {"node": node, "path": "scale"}}],
    })


def gltf(image=None):
    """Uses every feature of the reader. `image` is the texture's location; by default, the buffer."""
    file = Gltf()
    file.add("images", image or {"bufferView": file.view(images.png()), "mimeType": "image/png"})
    file.add("samplers", {"wrapS": 33071, "magFilter": 9728})
    file.add("textures", {"source": 0, "sampler": 0})
    file.add("materials", material({"index": 0, "texCoord": 0}))
    shape = mesh(file)
    file.add("cameras", {"name": "main", "type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}, "extras": {"relume": {"lens_radius": 0.01, "focus_distance": 4}}})
    file.add("cameras", {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0.1, "zfar": 9}})
    lights = [{"type": "spot", "intensity": 40, "spot": {"outerConeAngle": 0.6}}, {"type": "directional", "color": [1, 0.9, 0.8]}, {"type": "point", "range": 10}]
    file.doc["extensions"] = {"KHR_lights_punctual": {"lights": lights}}
    places = file.accessor([1, 2, 3, 4, 5, 6], "VEC3")
    child = file.node(root=False, mesh=shape, matrix=[2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 5, 6, 7, 1])
    part = file.node(name="part", mesh=shape, children=[child], rotation=[0, 0, 0, 1], scale=[1, 1, 1])
    file.node(mesh=shape, extensions={"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places}}})
    camera = file.node(camera=0, translation=[0, 0, 5])
    for light in range(3):
        file.node(translation=[0, 0, 3], extensions={"KHR_lights_punctual": {"light": light}})
    animate(file, part, camera)
    file.add("skins", {"joints": [part, child], "inverseBindMatrices": file.accessor([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] * 2, "MAT4")})
    file.node(mesh=shape, skin=0)
    file.doc["scenes"][0]["extras"] = {"relume": {"environment": {"sun_sky": {"elevation_deg": 30, "turbidity": 3}, "rotation_deg": 10}, "settings": {"max-bounces": 4}}}
    file.doc["extensionsUsed"] = ["KHR_lights_punctual", "KHR_texture_transform", "EXT_mesh_gpu_instancing", "KHR_materials_ior"]
    return file


def compressed(name):
    """A triangle with normals compressed by EXT_meshopt_compression, or a mesh of invalid Draco data."""
    file = Gltf()
    indices = file.accessor([0, 1, 2], component=U16)
    positions = file.accessor([0, 0, 0, 1, 0, 0, 0, 1, 0], "VEC3")
    primitive = {"attributes": {"POSITION": positions}, "indices": indices}
    if name == "KHR_draco_mesh_compression":
        data = file.view(b"DRACO\2\2\1\1\0\0" + bytes(range(64)))
        primitive["extensions"] = {name: {"bufferView": data, "attributes": {"POSITION": 0}}}
    else:
        primitive["attributes"]["NORMAL"] = normals = file.accessor([0, 0, 1] * 3, "VEC3")
        view = file.doc["bufferViews"][file.doc["accessors"][normals]["bufferView"]]
        at = len(file.data)
        packed = b"\xa0" + bytes(12) + bytes(20) + struct.pack("<3f", 0, 0, 1)  # zero differences, then the first vertex
        file.data += packed
        view["byteStride"] = 12
        view["extensions"] = {name: {"buffer": 0, "byteOffset": at, "byteLength": len(packed), "byteStride": 12, "count": 3, "mode": "ATTRIBUTES"}}
    file.add("meshes", {"primitives": [primitive]})
    file.node(mesh=0)
    file.doc["extensionsUsed"] = file.doc["extensionsRequired"] = [name]
    return file.text()


OBJ = b"""mtllib a.mtl
usemtl m
o one
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
vt 0 0
vt 1 0
vt 1 1
vt 0 1
vn 0 0 1
f 1/1/1 2/2/1 3/3/1 4/4/1
g two
s off
f -4//1 -3//1 -2//1
l 1 2 3
p 1
f 1 2 3
"""
MTL = "newmtl m\nKd 0.8 0.7 0.6\nKs 0.2 0.2 0.2\nKe 0 0 0\nNs 40\nd 0.9\nillum 2\nmap_Kd {0}\nmap_Ke {0}\nmap_d {0}\nbump -bm 0.5 {0}\n"


def obj(texture, data):
    return {"a.obj": OBJ, "a.mtl": MTL.format(texture).encode(), texture: data}


def ply(form):
    vertex = "property float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty float u\nproperty float v\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
    head = f"ply\nformat {form} 1.0\ncomment a patch\nelement vertex 4\n{vertex}element face 2\nproperty list uchar int vertex_indices\nend_header\n".encode()
    rows = [(x, y, 0, 0, 0, 1, x, y, 255, 128 * x, 128 * y) for x, y in ((0, 0), (1, 0), (0, 1), (1, 1))]
    faces = [(3, 0, 1, 2), (3, 1, 3, 2)]
    if form == "ascii":
        return head + "".join(" ".join(map(str, row)) + "\n" for row in rows + faces).encode()
    order = "<" if "little" in form else ">"
    return head + b"".join(struct.pack(order + "8f3B", *row) for row in rows) + b"".join(struct.pack(order + "B3i", *face) for face in faces)


STL = b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n"
OFF = b"OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0.5\n3 0 1 2\n3 1 3 2\n"


def binary_stl():
    corners = struct.pack("<12fH", 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0)
    return b"relume".ljust(80) + struct.pack("<I", 2) + 2 * corners


def file_3ds():
    def chunk(number, *parts):
        data = b"".join(parts)
        return struct.pack("<HI", number, 6 + len(data)) + data

    corners = struct.pack("<H9f", 3, 0, 0, 0, 1, 0, 0, 0, 1, 0)
    faces = struct.pack("<5H", 1, 0, 1, 2, 0)
    paint = chunk(0xafff, chunk(0xa000, b"paint\0"), chunk(0xa020, chunk(0x0011, b"\xc0\x80\x40")))
    shape = chunk(0x4000, b"m\0", chunk(0x4100, chunk(0x4110, corners), chunk(0x4120, faces, chunk(0x4130, b"paint\0", struct.pack("<2H", 1, 0)))))
    lamp = chunk(0x4000, b"l\0", chunk(0x4600, struct.pack("<3f", 0, 0, 3)))
    return chunk(0x4d4d, chunk(0x0002, struct.pack("<I", 3)), chunk(0x3d3d, paint, shape, lamp))


FBX = b"""; FBX 7.4.0 project file
FBXHeaderExtension: {
 FBXHeaderVersion: 1003
 FBXVersion: 7400
}
GlobalSettings: {
 Version: 1000
 Properties70: {
  P: "UpAxis", "int", "Integer", "",2
  P: "UpAxisSign", "int", "Integer", "",1
  P: "FrontAxis", "int", "Integer", "",1
  P: "FrontAxisSign", "int", "Integer", "",-1
  P: "CoordAxis", "int", "Integer", "",0
  P: "CoordAxisSign", "int", "Integer", "",1
  P: "UnitScaleFactor", "double", "Number", "",1
 }
}
Objects: {
 Geometry: 1, "Geometry::g", "Mesh" {
  Vertices: *9 {
   a: 0,0,100,100,0,100,0,100,100
  }
  PolygonVertexIndex: *3 {
   a: 0,1,-3
  }
  GeometryVersion: 124
 }
 Model: 2, "Model::m", "Mesh" {
  Version: 232
  Properties70: {
   P: "Lcl Translation", "Lcl Translation", "", "A",1,2,3
  }
 }
 Material: 3, "Material::paint", "" {
  Properties70: {
   P: "DiffuseColor", "Color", "", "A",0.8,0.7,0.6
  }
 }
}
Connections: {
 C: "OO",2,0
 C: "OO",1,2
 C: "OO",3,2
}
"""

DAE = b"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
<library_cameras><camera id="c" name="cam"><optics><technique_common><perspective><yfov>40</yfov><aspect_ratio>2</aspect_ratio><znear>1</znear><zfar>100</zfar></perspective></technique_common></optics></camera></library_cameras>
<library_lights><light id="l" name="lamp"><technique_common><point><color>2 3 4</color></point></technique_common></light></library_lights>
<library_images><image id="i"><init_from>a.png</init_from></image></library_images>
<library_effects><effect id="e"><profile_COMMON><technique sid="t"><lambert><diffuse><color>0.8 0.7 0.6 1</color></diffuse></lambert></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m" name="paint"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="9">0 0 100 100 0 100 0 100 100</float_array><technique_common><accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1" material="m"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries>
<library_nodes><node id="q"><instance_geometry url="#g"/></node></library_nodes>
<library_visual_scenes><visual_scene id="s"><node id="n"><matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix><instance_geometry url="#g"/><instance_node url="#q"/></node>
<node id="cn" name="cn"><instance_camera url="#c"/></node><node id="ln" name="ln"><instance_light url="#l"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
"""


MITSUBA = b"""<?xml version="1.0"?>
<scene version="3.0.0">
<default name="size" value="8"/><path value="textures"/>
<integrator type="path"><integer name="max_depth" value="5"/></integrator>
<sensor type="perspective"><float name="fov" value="60"/><string name="fov_axis" value="larger"/>
<transform name="to_world"><lookat origin="0, 1, 6" target="0, 0, 0" up="0, 1, 0"/></transform>
<film type="hdrfilm"><integer name="width" value="$size"/><integer name="height" value="$size"/></film>
<sampler type="independent"><integer name="sample_count" value="2"/></sampler></sensor>
<include filename="b.xml"/>
<bsdf type="mask" id="mask"><texture type="bitmap" name="opacity"><string name="filename" value="a.png"/></texture><ref id="paint"/></bsdf>
<bsdf type="bumpmap" id="bump"><texture type="bitmap"><string name="filename" value="a.png"/><boolean name="raw" value="true"/></texture><float name="scale" value="2"/><bsdf type="plastic"/></bsdf>
<bsdf type="blendbsdf" id="blend"><float name="weight" value="0.4"/><bsdf type="roughconductor"><spectrum name="eta" filename="a.spd"/><float name="alpha_u" value="0.1"/><float name="alpha_v" value="0.3"/></bsdf><ref id="paint"/></bsdf>
<shape type="sphere"><point name="center" x="1" y="0" z="0"/><float name="radius" value="0.7"/><bsdf type="roughdielectric"><string name="int_ior" value="diamond"/></bsdf></shape>
<shape type="cylinder"><point name="p1" value="0, 1, 0"/><float name="radius" value="0.2"/><ref id="mask"/></shape>
<shape type="obj"><string name="filename" value="a.obj"/><transform name="to_world"><rotate x="1" angle="-90"/><scale value="2"/><translate y="-1"/></transform><ref id="bump"/></shape>
<shape type="serialized"><string name="filename" value="a.serialized"/><integer name="shape_index" value="1"/><ref id="blend"/></shape>
<shape type="shapegroup" id="group"><shape type="ply"><string name="filename" value="a.ply"/><bsdf type="diffuse"><texture type="mesh_attribute" name="reflectance"><string name="name" value="vertex_color"/></texture></bsdf></shape></shape>
<shape type="instance"><ref id="group"/><transform name="to_world"><matrix value="1 0 0 -2 0 1 0 0 0 0 1 0 0 0 0 1"/></transform></shape>
<shape type="rectangle"><transform name="to_world"><translate y="3"/></transform><emitter type="area"><spectrum name="radiance" value="400:2, 500:3, 700:5"/></emitter></shape>
<emitter type="spot"><float name="cutoff_angle" value="30"/></emitter>
<emitter type="envmap"><string name="filename" value="a.hdr"/><transform name="to_world"><rotate x="1" angle="90"/></transform></emitter>
</scene>
"""


def serialized():
    """Two meshes of one triangle in version 4 of Mitsuba's format, with texture coordinates."""
    body = struct.pack("<I2sQQ9f6f3I", 0x1002, b"m\0", 3, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 1, 2)
    mesh = struct.pack("<HH", 0x041c, 4) + zlib.compress(body)
    return mesh + mesh + struct.pack("<QQI", 0, len(mesh), 2)


def mitsuba():
    part = b'<scene version="3.0.0"><bsdf type="twosided" id="paint"><bsdf type="principled"><rgb name="base_color" value="0.8 0.4 0.1"/></bsdf></bsdf></scene>'
    return {"a.xml": MITSUBA, "b.xml": part, "a.png": images.png(), "a.obj": OBJ, "a.ply": ply("ascii"), "a.serialized": serialized(),
            "a.spd": b"# eta\n400 1.5\n700 0.2\n", "a.hdr": images.hdr()}


def relume_json(scene, material="paint", node="part", environment=None):
    return json.dumps({
        "scene": scene, "camera": {"eye": [0, 0, 5], "target": [0, 0, 0], "fov_y_deg": 40, "lens_radius": 0.1, "focus_distance": 4},
        "camera_keys": [{"time": 0, "eye": [0, 0, 5], "target": [0, 0, 0]}, {"time": 1, "eye": [5, 0, 0], "target": [0, 0, 0]}],
        "lights": [{"type": "spot", "name": "lamp", "position": [0, 3, 0], "direction": [0, -1, 0], "intensity": [10, 9, 8], "outer_cone_deg": 30}],
        "environment": environment or {"sun_sky": {"elevation_deg": 30, "azimuth_deg": 90, "turbidity": 3}, "rotation_deg": 10, "scale": [1, 1, 1]},
        "materials": {material: {"roughness": 0.5, "base_color": [0.5, 0.5, 0.5], "transmission": 0.5, "thickness": 1}},
        "nodes": {node: {"keys": [{"time": 0, "rotation_deg": [0, 0, 0]}, {"time": 2, "rotation_deg": [0, 360, 0]}]}},
        "settings": {"max-bounces": 4, "lights": "light-tree"},
    }, indent=1).encode()


PBRT = b"""LookAt 0 -4 1.5  0 0 0.5  0 0 1
Camera "perspective" "float fov" 50 "float lensradius" 0.01
Film "rgb" "integer xresolution" 32 "integer yresolution" 24 "float iso" 150
Sampler "halton" "integer pixelsamples" 2
Integrator "path" "integer maxdepth" 4
WorldBegin
Texture "image" "spectrum" "imagemap" "string filename" "a.png" "float uscale" 2
Texture "squares" "spectrum" "checkerboard" "float uscale" 4 "texture tex1" "image" "rgb tex2" [0.1 0.2 0.3]
MakeNamedMaterial "a" "string type" "coateddiffuse" "texture reflectance" "squares" "float roughness" 0.1
MakeNamedMaterial "b" "string type" "conductor" "spectrum eta" "metal-Au-eta" "spectrum k" "metal-Au-k" "float uroughness" 0.1
MakeNamedMaterial "c" "string type" "mix" "string materials" ["a" "b"] "float amount" 0.3
LightSource "infinite" "rgb L" [0.2 0.3 0.4] "float scale" 2
LightSource "spot" "blackbody I" 3000 "point3 from" [0 0 3] "point3 to" [0 0 0] "float power" 50
NamedMaterial "c"
AttributeBegin
  AreaLightSource "diffuse" "spectrum L" [400 1 700 3] "float power" 10
  Translate 0.5 0 1 Rotate 30 1 0 0
  Shape "disk" "float radius" 0.4
AttributeEnd
ObjectBegin "o"
  Shape "plymesh" "string filename" "b.ply"
  Shape "sphere" "float radius" 0.4 "float zmin" -0.2 "float phimax" 200
ObjectEnd
ObjectInstance "o"
Scale -1 2 1
ObjectInstance "o"
Include "c.pbrt"
"""
PBRT_PART = b"""AttributeBegin
Material "dielectric" "spectrum eta" "glass-BK7"
Shape "loopsubdiv" "integer levels" 2 "point3 P" [0 0 0 1 0 0 0 1 0 0 0 1] "integer indices" [0 2 1 0 1 3 1 2 3 2 0 3]
Shape "bilinearmesh" "point3 P" [-1 -1 0 1 -1 0 -1 1 0 1 1 0.5] "integer indices" [0 1 2 3] "float alpha" 0.5
AttributeEnd
"""


def all_scenes():
    """Lists of scenes by kind."""
    rich = gltf()
    return {
        "gltf": [{"a.gltf": rich.text()}, {"a.gltf": rich.text("a.bin"), "a.bin": rich.data},
                 {"a.gltf": gltf({"uri": "a%20b.png"}).text(), "a b.png": images.png(depth=16)}, {"a.gltf": gltf({"uri": "a.jpg"}).text(), "a.jpg": images.jpeg()},
                 {"a.gltf": compressed("KHR_draco_mesh_compression")}, {"a.gltf": compressed("EXT_meshopt_compression")}],
        "glb": [{"a.glb": rich.glb()}],
        "relume json": [{"a.json": relume_json("a.glb"), "a.glb": rich.glb()}, {"a.json": relume_json("builtin:cornell", "white", "lamp")}],
        "obj": [obj("a.png", images.png())],
        "mitsuba": [mitsuba()],
        "ply": [{"a.ply": ply(form)} for form in ("ascii", "binary_little_endian", "binary_big_endian")],
        "pbrt": [{"a.pbrt": PBRT, "c.pbrt": PBRT_PART, "b.ply": ply("ascii"), "a.png": images.png()},
                 {"a.pbrt.gz": gzip.compress(PBRT), "c.pbrt": PBRT_PART, "b.ply": ply("binary_little_endian"), "a.png": images.png()}],
        "stl": [{"a.stl": STL}, {"a.stl": binary_stl()}],
        "off": [{"a.off": OFF}],
        "dae": [{"a.dae": DAE}],
        "fbx": [{"a.fbx": FBX}],
        "3ds": [{"a.3ds": file_3ds()}],
    }
