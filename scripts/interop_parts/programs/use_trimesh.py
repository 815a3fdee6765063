"""trimesh: one mesh with colours, and a scene of two with materials."""
import numpy as np
import trimesh
from house_json import BACK, OUT, attempt, house, told
from PIL import Image

triangles, slots = np.array(house["triangles"]), np.array(house["triangle_materials"])


def arrays():
    return dict(vertices=house["corner_positions"], vertex_normals=house["corner_normals"], process=False)


def colored():
    colors = np.round(255 * np.array(house["corner_srgb_colors"])).astype(np.uint8)
    return trimesh.Trimesh(faces=triangles, vertex_colors=colors, **arrays())


def textured():
    scene = trimesh.Scene()
    for i, m in enumerate(house["materials"]):
        used, local = np.unique(triangles[slots == i], return_inverse=True)
        image = Image.open(OUT + m["texture"]) if m["texture"] else None
        material = trimesh.visual.material.PBRMaterial(name=m["name"], baseColorFactor=[*m["color"], 1.0], baseColorTexture=image, metallicFactor=0.0)
        visual = trimesh.visual.TextureVisuals(uv=np.array(house["corner_uvs"])[used], material=material)
        scene.add_geometry(trimesh.Trimesh(vertices=np.array(house["corner_positions"])[used], faces=local.reshape(-1, 3), visual=visual,
                                           vertex_normals=np.array(house["corner_normals"])[used], process=False))
    return scene


print(trimesh.__version__)
for name in ("colors.obj", "colors.ply", "colors.stl", "colors.glb"):
    option = {"stl": {}, "ply": {"vertex_normal": True}}.get(name[-3:], {"include_normals": True})
    attempt(name, lambda: colored().export(OUT + name, **option))
attempt("obj", lambda: textured().export(OUT + "house.obj", include_normals=True))
attempt("glb", lambda: textured().export(OUT + "house.glb", include_normals=True))
for form in ("obj", "ply", "stl", "glb"):
    def read():
        scene = trimesh.load("%shouse.%s" % (BACK, form), force="scene", process=False)
        positions, faces, normals, uvs, colors, slots, materials = [], [], [], [], [], [], []
        for node in scene.graph.nodes_geometry:
            matrix, name = scene.graph[node]
            g = scene.geometry[name].copy(include_cache=True)
            g.apply_transform(matrix)
            faces += [[len(positions) + k for k in face] for face in g.faces.tolist()]
            positions += g.vertices.tolist()
            normals += g.vertex_normals.tolist()
            if g.visual.kind == "texture" and g.visual.uv is not None:
                uvs += g.visual.uv.tolist()
                m = g.visual.material
                if hasattr(m, "baseColorFactor"):
                    color, image = m.baseColorFactor, m.baseColorTexture
                else:
                    color, image = m.diffuse, m.image
                materials.append([str(m.name), [c / 255 for c in (color if color is not None else (255, 255, 255))[:3]], image is not None])
                color = g.visual.vertex_attributes.get("color") if hasattr(g.visual, "vertex_attributes") else None
                colors += (np.asarray(color)[:, :3] / 255).tolist() if color is not None else []
            elif g.visual.kind == "vertex":
                colors += (g.visual.vertex_colors[:, :3] / 255).tolist()
            slots += [len(materials) - 1] * len(g.faces)
        told(form, faces, positions, normals, uvs or None, colors or None, False, materials, slots)
    attempt("read " + form, read)
