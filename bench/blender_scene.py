"""Renders a directory that path_peers has written with Blender's Cycles: blender -b -P blender_scene.py -- DIR SEED SPP...

Writes one picture, DIR/cycles_SPP.exr, for each number of samples. Prints "cycles SPP SECONDS" for each, where the
seconds are those of the whole render call, the building of the scene included.

Environment: OKTETT_PEER_THREADS is the number of threads (2). OKTETT_PEER_ADAPTIVE is the noise at which pixels get no more
samples; without it all get the same number. OKTETT_PEER_PART="X0 Y0 X1 Y1" renders only the pixels
from column X0 to before X1 and from row Y0 to before Y1; row 0 is the top.
"""
import json
import os
import sys
import time

import bpy
import numpy as np


def load_mesh(directory):
    """The mesh whose columns are in the directory, in Blender's axes, with flat triangles."""
    def column(name, kind):
        return np.fromfile(os.path.join(directory, name), kind)

    positions = column("positions.f32", np.float32).reshape(-1, 3)
    indices, slots = column("indices.u32", np.int32), column("slots.u16", np.uint16)
    count = len(indices) // 3
    mesh = bpy.data.meshes.new("scene")
    mesh.vertices.add(len(positions))
    mesh.vertices.foreach_set("co", (positions[:, [0, 2, 1]] * np.float32([1, -1, 1])).ravel())  # Blender's z is up
    mesh.loops.add(3 * count)
    mesh.loops.foreach_set("vertex_index", indices)
    mesh.polygons.add(count)
    mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * count, 3, np.int32))
    if bpy.app.version < (4, 1, 0):
        mesh.polygons.foreach_set("loop_total", np.full(count, 3, np.int32))
    mesh.polygons.foreach_set("use_smooth", np.zeros(count, bool))
    if os.path.exists(os.path.join(directory, "uvs.f32")):
        uvs = column("uvs.f32", np.float32).reshape(-1, 2)
        mesh.uv_layers.new().data.foreach_set("uv", uvs[indices].ravel())
    mesh.update(calc_edges=True)
    mesh.polygons.foreach_set("material_index", slots.astype(np.int32))
    return mesh


def make_material(description, directory):
    material = bpy.data.materials.new(description["name"])
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    output = nodes.new("ShaderNodeOutputMaterial")
    color = description["color"] + [1]
    kind = description["kind"]
    if kind == "lamp":
        shader = nodes.new("ShaderNodeEmission")
        strength = max(description["color"])
        color = [c / strength for c in description["color"]] + [1]
        shader.inputs["Strength"].default_value = strength
    elif kind == "metal":
        shader = nodes.new("ShaderNodeBsdfGlossy")
        shader.distribution = "MULTI_GGX"
        shader.inputs["Roughness"].default_value = description["roughness"]
    elif kind == "glass":
        shader = nodes.new("ShaderNodeBsdfGlass")
        shader.inputs["Roughness"].default_value = 0  # smooth; the distribution SHARP is gone in Blender 4
        shader.inputs["IOR"].default_value = description["ior"]
    else:
        shader = nodes.new("ShaderNodeBsdfDiffuse")
    shader.inputs["Color"].default_value = color
    if description["texture"]:
        picture = nodes.new("ShaderNodeTexImage")
        picture.image = bpy.data.images.load(os.path.join(directory, "texture_%s.png" % description["name"]))
        links.new(picture.outputs["Color"], shader.inputs["Color"])
    links.new(shader.outputs[0], output.inputs["Surface"])
    return material


def make_camera(scene, description):
    def turned(p):
        return (p[0], -p[2], p[1])

    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit = "VERTICAL"
    camera.angle = description["fov"] * 3.141592653589793 / 180
    camera.clip_start = 1e-3
    thing = bpy.data.objects.new("camera", camera)
    from mathutils import Vector

    start, end = Vector(turned(description["from"])), Vector(turned(description["at"]))
    thing.location = start
    thing.rotation_mode = "QUATERNION"
    thing.rotation_quaternion = (end - start).to_track_quat("-Z", "Y")
    scene.collection.objects.link(thing)
    scene.camera = thing


def make_world(scene, directory, description):
    world = bpy.data.worlds.new("world")
    scene.world = world
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    background = nodes["Background"]
    background.inputs["Color"].default_value = description["background"] + [1]
    if description["environment"]:
        picture = nodes.new("ShaderNodeTexEnvironment")
        picture.image = bpy.data.images.load(os.path.join(directory, "environment.exr"))
        picture.image.colorspace_settings.name = "Non-Color"
        links.new(picture.outputs["Color"], background.inputs["Color"])


def configure(scene, description, seed):
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = description["size"]
    scene.render.resolution_percentage = 100
    part = os.environ.get("OKTETT_PEER_PART")
    if part:
        (width, height), (x0, y0, x1, y1) = description["size"], map(int, part.split())
        scene.render.use_border = True
        scene.render.border_min_x, scene.render.border_max_x = x0 / width, x1 / width
        scene.render.border_min_y, scene.render.border_max_y = 1 - y1 / height, 1 - y0 / height
    scene.render.threads_mode = "FIXED"
    scene.render.threads = int(os.environ.get("OKTETT_PEER_THREADS", "2"))
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.image_settings.color_mode = "RGB"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.seed = seed
    cycles.use_denoising = False
    adaptive = os.environ.get("OKTETT_PEER_ADAPTIVE")
    cycles.use_adaptive_sampling = adaptive is not None
    if adaptive:
        cycles.adaptive_threshold = float(adaptive)
    cycles.pixel_filter_type = "BOX"
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.light_sampling_threshold = 0
    cycles.blur_glossy = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    depth = description["depth"]
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = depth
    cycles.transmission_bounces = cycles.transparent_max_bounces = depth


def main():
    words = sys.argv[sys.argv.index("--") + 1 :]
    directory, seed, samples = words[0], int(words[1]), [int(word) for word in words[2:]]
    with open(os.path.join(directory, "scene.json")) as text:
        description = json.load(text)
    scene = bpy.context.scene
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    configure(scene, description, seed)
    mesh = load_mesh(directory)
    for material in description["materials"]:
        mesh.materials.append(make_material(material, directory))
    scene.collection.objects.link(bpy.data.objects.new("scene", mesh))
    make_camera(scene, description["camera"])
    make_world(scene, directory, description)
    for count in samples:
        scene.cycles.samples = count
        scene.render.filepath = os.path.join(directory, "cycles_%d.exr" % count)
        start = time.time()
        bpy.ops.render.render(write_still=True)
        print("cycles", count, time.time() - start, flush=True)


main()
