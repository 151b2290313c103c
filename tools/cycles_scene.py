"""Renders a glTF scene in Cycles with relume's settings. tools/compare_cycles runs it inside Blender:

    blender -b --factory-startup --python tools/cycles_scene.py -- SCENE.gltf --width W ... --output FILE.exr

Replaces all surfaces by Lambertian ones of the same base colour. Emitters emit emissiveFactor times
KHR_materials_emissive_strength. Alpha masks and blending are as in glTF. Renders the scene's first camera with a
one-pixel box filter, without denoising, clamping and adaptive sampling. Prints "seconds: X", from preparation to output,
after Blender's own output."""

import argparse
import json
import pathlib
import sys
import time

import bpy
import numpy

# Blender 3.4's importer uses names that NumPy 1.24 removed.
numpy.bool, numpy.int, numpy.float = bool, int, float


def parse_options():
    parser = argparse.ArgumentParser()
    parser.add_argument("scene", type=pathlib.Path)
    for name in ("width", "height", "spp", "max-bounces", "seed"):
        parser.add_argument(f"--{name}", type=int, required=True)
    parser.add_argument("--env", type=lambda text: [float(v) for v in text.split(",")], required=True)
    parser.add_argument("--output", required=True)
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1 :])


def set_up_cycles(scene, options):
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.seed = "CPU", options.spp, options.seed
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.time_limit = 0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1
    # Cycles does not count the scattering event at the last vertex, so its limit is one less than relume's.
    bounces = options.max_bounces - 1
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = bounces
    cycles.transparent_max_bounces = 64


def set_up_image(scene, options):
    render = scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = options.width, options.height, 100
    render.use_compositing = render.use_sequencer = False
    settings = render.image_settings
    settings.file_format, settings.color_depth, settings.color_mode = "OPEN_EXR", "32", "RGB"
    render.filepath = options.output


def set_up_camera(scene, gltf):
    scene.camera = next(o for o in bpy.data.objects if o.type == "CAMERA")
    camera = scene.camera.data
    # glTF specifies the vertical angle; the importer adapts it to the file's aspect ratio.
    camera.sensor_fit, camera.angle = "VERTICAL", gltf["cameras"][0]["perspective"]["yfov"]
    camera.clip_start, camera.clip_end = 0.001, 10000


def set_up_environment(scene, radiance):
    scene.world = bpy.data.worlds.new("environment")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (*radiance, 1)


def radiance_of(material):
    factor = material.get("emissiveFactor", (0, 0, 0))
    strength = material.get("extensions", {}).get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1)
    return [strength * value for value in factor]


def source_of(socket):
    return socket.links[0].from_socket if socket.links else None


def become_lamp(material, radiance):
    tree = material.node_tree
    tree.nodes.clear()
    emission = tree.nodes.new("ShaderNodeEmission")
    emission.inputs["Color"].default_value, emission.inputs["Strength"].default_value = (*radiance, 1), 1
    tree.links.new(emission.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])


def become_lambert(material):
    tree = material.node_tree
    principled = next(n for n in tree.nodes if n.type == "BSDF_PRINCIPLED")
    colour, alpha = principled.inputs["Base Color"], source_of(principled.inputs["Alpha"])
    diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = colour.default_value[:]
    if source_of(colour):
        tree.links.new(source_of(colour), diffuse.inputs["Color"])
    surface = diffuse.outputs[0]
    if alpha:
        if material.blend_method == "CLIP":
            alpha = cut_at(tree, alpha, material.alpha_threshold)
        surface = seen_where(tree, alpha, surface)
    output = next(n for n in tree.nodes if n.type == "OUTPUT_MATERIAL")
    tree.links.new(surface, output.inputs["Surface"])
    tree.nodes.remove(principled)


def cut_at(tree, alpha, threshold):
    compare = tree.nodes.new("ShaderNodeMath")
    compare.operation = "LESS_THAN"
    compare.inputs[1].default_value = threshold
    tree.links.new(alpha, compare.inputs[0])
    inverse = tree.nodes.new("ShaderNodeMath")
    inverse.operation = "SUBTRACT"
    inverse.inputs[0].default_value = 1
    tree.links.new(compare.outputs[0], inverse.inputs[1])
    return inverse.outputs[0]


def seen_where(tree, alpha, surface):
    mix = tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(alpha, mix.inputs[0])
    tree.links.new(tree.nodes.new("ShaderNodeBsdfTransparent").outputs[0], mix.inputs[1])
    tree.links.new(surface, mix.inputs[2])
    return mix.outputs[0]


def main():
    options = parse_options()
    gltf = json.loads(options.scene.read_text(encoding="utf-8"))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=str(options.scene), import_shading="NORMALS", merge_vertices=False)
    scene = bpy.context.scene
    scene.render.threads_mode = "AUTO"
    set_up_cycles(scene, options)
    set_up_image(scene, options)
    set_up_camera(scene, gltf)
    set_up_environment(scene, options.env)
    lamps = {m.get("name"): radiance_of(m) for m in gltf.get("materials", ()) if any(radiance_of(m))}
    for material in bpy.data.materials:
        if material.name in lamps:
            become_lamp(material, lamps[material.name])
        elif material.node_tree:
            become_lambert(material)
    start = time.perf_counter()
    bpy.ops.render.render(write_still=True)  # prints sampling times to standard output
    print(f"seconds: {time.perf_counter() - start:.3f}", flush=True)


main()
