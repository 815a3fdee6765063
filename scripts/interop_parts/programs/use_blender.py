"""Blender: every exporter of its own that writes what Oktett reads, and the importers for the way back."""
import json
import sys

import bpy

sys.path.append("/programs")  # Blender looks for modules in its own folders alone
from house_json import BACK, OUT, attempt, house


def empty():
    bpy.ops.wm.read_factory_settings(use_empty=True)


def build():
    mesh = bpy.data.meshes.new("house")
    mesh.from_pydata(house["positions"], [], house["faces"])
    uv = mesh.uv_layers.new(name="UVMap")
    for i, value in enumerate(house["corner_uvs"]):
        uv.data[i].uv = value
    colors = mesh.color_attributes.new("Color", "FLOAT_COLOR", "POINT")
    for i, value in enumerate(house["colors"]):
        colors.data[i].color = (*value, 1)
    mesh.color_attributes.active_color = colors
    for m in house["materials"]:
        material = bpy.data.materials.new(m["name"])
        material.use_nodes = True
        shader = material.node_tree.nodes["Principled BSDF"]
        shader.inputs["Base Color"].default_value = (*m["color"], 1)
        if m["texture"]:
            image = material.node_tree.nodes.new("ShaderNodeTexImage")
            image.image = bpy.data.images.load(OUT + m["texture"])
            material.node_tree.links.new(image.outputs["Color"], shader.inputs["Base Color"])
        mesh.materials.append(material)
    for i, polygon in enumerate(mesh.polygons):
        polygon.material_index = house["face_materials"][i]
        polygon.use_smooth = True
    if hasattr(mesh, "use_auto_smooth"):
        mesh.use_auto_smooth = True
    mesh.normals_split_custom_set(house["corner_normals"])
    thing = bpy.data.objects.new("house", mesh)
    bpy.context.scene.collection.objects.link(thing)
    bpy.context.view_layer.objects.active = thing
    thing.select_set(True)


def dump(path):
    """All meshes of the scene, in the scene's space."""
    data = {"vertices": 0, "polygons": [], "slots": [], "materials": []}
    for thing in [t for t in bpy.context.scene.objects if t.type == "MESH"]:
        mesh, move = thing.data, thing.matrix_world
        if hasattr(mesh, "calc_normals_split"):
            mesh.calc_normals_split()
        turn = move.to_3x3().inverted().transposed()
        first = len(data["materials"])
        for material in mesh.materials:
            shader = material.node_tree.nodes.get("Principled BSDF") if material and material.use_nodes else None
            color = list(shader.inputs["Base Color"].default_value[:3]) if shader else [0, 0, 0]
            links = shader.inputs["Base Color"].links if shader else []
            texture, nodes = False, [link.from_node for link in links]
            while nodes:
                node = nodes.pop()
                texture = texture or node.type == "TEX_IMAGE" and node.image is not None and node.image.size[0] > 0
                if node.type == "MIX":  # with the colours of vertices
                    color = next((list(s.default_value[:3]) for s in node.inputs if s.type == "RGBA" and not s.links), color)
                nodes += [link.from_node for socket in node.inputs for link in socket.links]
            data["materials"].append([material.name if material else "", [1, 1, 1] if texture else color, texture])
        uv = mesh.uv_layers.active
        colors = mesh.color_attributes.active_color if len(mesh.color_attributes) else None
        if colors is None and len(mesh.color_attributes):
            colors = mesh.color_attributes[0]
        data["vertices"] += len(mesh.vertices)
        for polygon in mesh.polygons:
            corners = []
            for k in polygon.loop_indices:
                v = mesh.loops[k].vertex_index
                color = colors.data[v if colors.domain == "POINT" else k].color[:3] if colors else None
                normal = turn @ (mesh.corner_normals[k].vector if hasattr(mesh, "corner_normals") else mesh.loops[k].normal)
                corners.append([list(move @ mesh.vertices[v].co), list(normal.normalized()),
                                list(uv.data[k].uv) if uv else None, list(color) if color else None])
            data["polygons"].append(corners)
            data["slots"].append(first + polygon.material_index if len(mesh.materials) else -1)
    json.dump(data, open(path, "w"))


old = bpy.app.version < (4, 0)
empty()
build()
bpy.ops.wm.save_as_mainfile(filepath="/tmp/house.blend")
axes = {"forward_axis": "Y", "up_axis": "Z"}
attempt("obj", lambda: bpy.ops.wm.obj_export(filepath=OUT + "house.obj", export_colors=True, path_mode="RELATIVE", **axes))
attempt("obj", lambda: bpy.ops.wm.obj_export(filepath=OUT + "triangles.obj", export_triangulated_mesh=True, path_mode="COPY", **axes))
if old:
    bpy.ops.preferences.addon_enable(module="io_mesh_ply")
    bpy.ops.preferences.addon_enable(module="io_mesh_stl")
    attempt("ply", lambda: bpy.ops.export_mesh.ply(filepath=OUT + "house.ply", axis_forward="Y", axis_up="Z"))
    attempt("ply", lambda: bpy.ops.export_mesh.ply(filepath=OUT + "text.ply", use_ascii=True, axis_forward="Y", axis_up="Z"))
    attempt("stl", lambda: bpy.ops.export_mesh.stl(filepath=OUT + "house.stl", axis_forward="Y", axis_up="Z"))
else:
    for name, options in (("house", {}), ("linear", {"export_colors": "LINEAR"}), ("text", {"ascii_format": True})):
        attempt("ply", lambda: bpy.ops.wm.ply_export(filepath="%s%s.ply" % (OUT, name), export_normals=True, **options, **axes))
    attempt("stl", lambda: bpy.ops.wm.stl_export(filepath=OUT + "house.stl", **axes))
bpy.ops.preferences.addon_enable(module="io_scene_gltf2")
for name, form in (("house", "GLB"), ("parts", "GLTF_SEPARATE")):
    options = {} if old else {"export_vertex_color": "ACTIVE"}
    attempt("glb", lambda: bpy.ops.export_scene.gltf(filepath=OUT + name, export_format=form, export_yup=False, **options))

for form, read in (
        ("obj", lambda p: bpy.ops.wm.obj_import(filepath=p, **axes)),
        ("ply", lambda p: bpy.ops.import_mesh.ply(filepath=p) if old else bpy.ops.wm.ply_import(filepath=p, **axes)),
        ("stl", lambda p: bpy.ops.import_mesh.stl(filepath=p, axis_forward="Y", axis_up="Z") if old else bpy.ops.wm.stl_import(filepath=p, **axes)),
        ("glb", lambda p: bpy.ops.import_scene.gltf(filepath=p))):
    empty()
    if old:
        bpy.ops.preferences.addon_enable(module="io_mesh_ply")
        bpy.ops.preferences.addon_enable(module="io_mesh_stl")
    bpy.ops.preferences.addon_enable(module="io_scene_gltf2")
    attempt("read " + form, lambda: (read("%shouse.%s" % (BACK, form)), dump("%sread_%s.json" % (OUT, form))))
