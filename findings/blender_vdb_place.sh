#!/usr/bin/env bash
# Blender's smoke is not where its OpenVDB files say, and grows or shrinks from frame to frame.
#
# One would guess: the transform of a grid says where its voxels are. OpenVDB's samplers put voxel (0, 0, 0) at the origin, and so does
# Blender, whose smoke has the same size of voxels in all files of a simulation.
# What happens: Blender 3.4.1 (Debian 12) and 4.3.2 (Debian 13) take a voxel for the cell from its index to the next. Cycles and the modifier
# "Volume to Mesh" show all OpenVDB files half a voxel further along each axis. With an adaptive domain, 3.4.1 writes voxels as large as if
# the cells of that frame filled the whole domain: 0.105 and 0.074 for cells of 0.0625. Blender itself reads the right size from other files
# of its cache.
# Why a user of a ray tracer meets it: smoke of Blender does not fit the scene around it, swells and shrinks in a film, and is too thick.
#
# Needs Debian 12 and its network. Debian 12: blender 3.4.1+dfsg-2+b1, python3-openvdb 10.0.1-2. Debian 13: blender 4.3.2+dfsg-2. About a
# minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"

cat >voxel.py <<'PYTHON'
import pyopenvdb

grid = pyopenvdb.FloatGrid()
grid.name = "density"
grid.fill((0, 0, 0), (0, 0, 0), 1)
pyopenvdb.write("voxel.vdb", [grid])
corners, _ = grid.convertToQuads(isovalue=0.5)
print("size", *grid.transform.voxelSize(), "middle", *(round(float(x), 6) + 0.0 for x in corners.mean(0)))
PYTHON
cat >shown.py <<'PYTHON'
import os

import bpy

scene = bpy.context.scene
for thing in list(bpy.data.objects):
    bpy.data.objects.remove(thing)
volume = bpy.data.volumes.new("Voxel")
volume.filepath = os.path.abspath("voxel.vdb")
shown = bpy.data.objects.new("Voxel", volume)
scene.collection.objects.link(shown)

# A black voxel in front of white, seen from above, 16 pixels to a unit.
black = bpy.data.materials.new("Black")
black.use_nodes = True
nodes = black.node_tree.nodes
nodes.clear()
smoke = nodes.new("ShaderNodeVolumePrincipled")
smoke.inputs["Color"].default_value = (0, 0, 0, 1)
black.node_tree.links.new(smoke.outputs[0], nodes.new("ShaderNodeOutputMaterial").inputs["Volume"])
volume.materials.append(black)
scene.world = bpy.data.worlds.new("World")
scene.world.use_nodes = True
scene.world.node_tree.nodes["Background"].inputs[0].default_value = (1, 1, 1, 1)
camera = bpy.data.cameras.new("Camera")
camera.type, camera.ortho_scale = "ORTHO", 4
scene.camera = bpy.data.objects.new("Camera", camera)
scene.camera.location = (0, 0, 10)
scene.collection.objects.link(scene.camera)
scene.render.engine = "CYCLES"
scene.cycles.samples, scene.cycles.use_denoising = 16, False
scene.render.resolution_x = scene.render.resolution_y = 64
scene.render.resolution_percentage = 100
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.filepath = os.path.abspath("voxel.exr")
bpy.ops.render.render(write_still=True)
pixels = bpy.data.images.load(scene.render.filepath).pixels[:][::4]
dark = [(1 - value, (i % 64 + 0.5) / 16 - 2, (i // 64 + 0.5) / 16 - 2) for i, value in enumerate(pixels)]
total = sum(d for d, x, y in dark)
print("CYCLES %.1f %.1f" % (sum(d * x for d, x, y in dark) / total, sum(d * y for d, x, y in dark) / total))

solid = bpy.data.objects.new("Mesh", bpy.data.meshes.new("Mesh"))
scene.collection.objects.link(solid)
modifier = solid.modifiers.new("Mesh", "VOLUME_TO_MESH")
modifier.object, modifier.threshold = shown, 0.5
corners = [v.co for v in solid.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh().vertices]
print("MESH %.1f %.1f %.1f" % tuple(sum(c[k] for c in corners) / len(corners) for k in range(3)))
PYTHON
cat >smoke.py <<'PYTHON'
import os

import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
bpy.ops.mesh.primitive_uv_sphere_add(segments=16, ring_count=8, radius=0.2)
source = bpy.context.object.modifiers.new("Fluid", "FLUID")
source.fluid_type = "FLOW"
source.flow_settings.flow_behavior = "INFLOW"
bpy.ops.mesh.primitive_cube_add(size=2)
domain = bpy.context.object
fluid = domain.modifiers.new("Fluid", "FLUID")
fluid.fluid_type = "DOMAIN"
settings = fluid.domain_settings
settings.resolution_max = 32
settings.use_adaptive_domain = True
settings.cache_frame_end = scene.frame_end = 12
settings.cache_data_format = "OPENVDB"
settings.cache_directory = os.path.abspath("cache")
bpy.context.view_layer.update()
settings.cache_type = "ALL"
bpy.ops.fluid.bake_all()
for frame in (1, 12):
    volume = bpy.data.volumes.new("Smoke")
    volume.filepath = os.path.abspath("cache/data/fluid_data_%04d.vdb" % frame)
    volume.grids.load()
    density = next(grid for grid in volume.grids if grid.name == "density")
    print("FRAME %d %.3f" % (frame, density.matrix_object[0][0]))
PYTHON

unpack bookworm amd64 python3-openvdb=10.0.1-2
guess "the middle of voxel (0, 0, 0) is at the origin"
seen "the voxel as a mesh by OpenVDB" "size 1.0 1.0 1.0 middle 0.0 0.0 0.0" "$(python voxel.py)"
# blender SCRIPT: runs it in Blender of $root.
blender() {
  local paths=$libraries:$root/usr/lib:$libraries/blas:$libraries/lapack:$libraries/pulseaudio
  HOME=$work PYTHONHOME=$root/usr BLENDER_SYSTEM_RESOURCES=$root/usr/share/blender BLENDER_SYSTEM_SCRIPTS=$root/usr/share/blender/scripts \
    BLENDER_SYSTEM_DATAFILES=$root/usr/share/blender/datafiles \
    "$root/lib64/ld-linux-x86-64.so.2" --library-path "$paths" "$root/usr/bin/blender" --background -noaudio --factory-startup --python-use-system-env \
    --python "$1" >log 2>&1
}
# shown SUITE VERSION: where that Blender shows the voxel.
shown() {
  unpack "$1" amd64 blender="$2"
  blender shown.py
  seen "its middle in Cycles, x and y" "0.5 0.5" "$(sed -n 's/^CYCLES //p' log)"
  seen "its middle as a mesh" "0.5 0.5 0.5" "$(sed -n 's/^MESH //p' log)"
}
guess "Blender shows it there"
shown trixie 4.3.2+dfsg-2
shown bookworm 3.4.1+dfsg-2+b1
guess "voxels of smoke are 2 / 32 = 0.0625 in all frames"
blender smoke.py
seen "voxels of frame 1" "0.105" "$(sed -n 's/^FRAME 1 //p' log)"
seen "voxels of frame 12" "0.074" "$(sed -n 's/^FRAME 12 //p' log)"
finish
