"""Open3D: a mesh of its legacy kind, and of its newer kind of tensors."""
import numpy as np
import open3d as o3d
from house_json import BACK, OUT, attempt, house, told


def build():
    mesh = o3d.geometry.TriangleMesh(o3d.utility.Vector3dVector(house["corner_positions"]), o3d.utility.Vector3iVector(house["triangles"]))
    mesh.vertex_normals = o3d.utility.Vector3dVector(house["corner_normals"])
    mesh.vertex_colors = o3d.utility.Vector3dVector(house["corner_srgb_colors"])
    mesh.triangle_uvs = o3d.utility.Vector2dVector(np.array(house["corner_uvs"])[np.array(house["triangles"]).ravel()])
    mesh.triangle_material_ids = o3d.utility.IntVector(house["triangle_materials"])
    image = o3d.geometry.Image(np.flipud(np.asarray(o3d.io.read_image(OUT + "corners.png"))).copy())  # as its reader of OBJ keeps them
    mesh.textures = [image] * 2
    mesh.compute_triangle_normals()
    return mesh


print(o3d.__version__)
mesh = build()
for name in ("house.obj", "house.ply", "house.stl", "house.glb", "house.gltf"):
    attempt(name, lambda: o3d.io.write_triangle_mesh(OUT + name, mesh))
attempt("text.ply", lambda: o3d.io.write_triangle_mesh(OUT + "text.ply", mesh, write_ascii=True))
for form in ("obj", "ply", "stl", "glb"):
    def read():
        m = o3d.io.read_triangle_mesh("%shouse.%s" % (BACK, form), True)
        told(form, np.asarray(m.triangles), np.asarray(m.vertices), np.asarray(m.vertex_normals) if m.has_vertex_normals() else None,
             np.asarray(m.triangle_uvs) if m.has_triangle_uvs() else None, np.asarray(m.vertex_colors) if m.has_vertex_colors() else None, True)
    attempt("read " + form, read)
