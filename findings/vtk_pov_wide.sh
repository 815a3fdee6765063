#!/usr/bin/env bash
# VTK's export for POV-Ray makes things too wide in all pictures that are not square.
#
# One would guess: the picture that POV-Ray makes of the file of vtkPOVExporter, at the size that the file's head names, is framed as VTK's.
# What happens: VTK 9.1.0 (Debian 12) and 9.3.0 (Debian 13) write `right <-1, 0, 0>` whatever the size, and their angle, which is the one from
# bottom to top, as `angle`, which is the one from left to right in POV-Ray. At 400 by 200 a cube is 39 by 39 pixels in VTK and 78 by 40 in
# POV-Ray, and what lies in the outer half of the picture is missing. The parallel scale of a parallel projection is lost as well: a cube of
# 100 by 100 pixels becomes one of 74 by 38.
# Why a user of a ray tracer meets it: windows of visualization programs are seldom square. Only a square picture has the right shapes.
#
# Needs Debian 12 and its network. Debian 12: povray 1:3.7.0.10-2+b2, python3-vtk9 9.1.0+really9.1.0+dfsg2-5+deb12u1. Debian 13:
# python3-vtk9 9.3.0+dfsg1-4+b1. About three minutes.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"

cat >export.py <<'PYTHON'
import sys

import vtk

size = int(sys.argv[2]), int(sys.argv[3])
cube = vtk.vtkCubeSource()
mapper = vtk.vtkPolyDataMapper()
mapper.SetInputConnection(cube.GetOutputPort())
actor = vtk.vtkActor()
actor.SetMapper(mapper)
actor.GetProperty().SetAmbient(1)
renderer = vtk.vtkRenderer()
renderer.AddActor(actor)
camera = renderer.GetActiveCamera()
camera.SetPosition(0, 0, 10)
camera.SetFocalPoint(0, 0, 0)
camera.SetViewAngle(30)
camera.SetParallelProjection(sys.argv[1] == "parallel")
camera.SetParallelScale(1)
window = vtk.vtkRenderWindow()
window.SetOffScreenRendering(1)
window.SetSize(*size)
window.AddRenderer(renderer)
exporter = vtk.vtkPOVExporter()
exporter.SetRenderWindow(window)
exporter.SetFileName("cube.pov")
exporter.Write()
# The near face of the cube by VTK's own matrix, in pixels.
matrix = camera.GetCompositeProjectionTransformMatrix(size[0] / size[1], -1, 1)
corner = matrix.MultiplyPoint((0.5, 0.5, 0.5, 1))
print("%d by %d" % tuple(size[i] * corner[i] / corner[3] for i in range(2)))
PYTHON
cat >measure.py <<'PYTHON'
import re

data = open("cube.ppm", "rb").read()
head = re.match(rb"P6\s+(?:#.*\n)*(\d+)\s+(\d+)\s+255\s", data)
width, pixels = int(head[1]), data[head.end() :]
lit = [i // 3 for i in range(0, len(pixels), 3) if any(pixels[i : i + 3])]
columns, rows = [i % width for i in lit], [i // width for i in lit]
print("%d by %d" % (max(columns) - min(columns) + 1, max(rows) - min(rows) + 1))
PYTHON
# in_povray: the cube in the picture that POV-Ray makes at the size that the exported file names.
in_povray() {
  local root=$root_pov libraries=$root_pov/usr/lib/x86_64-linux-gnu
  run "$root/usr/bin/povray" +Icube.pov +Ocube.ppm +FP -D -A +WT1 $(sed -n 's,^// \(+W.*\),\1,p' cube.pov) >log 2>&1
  python measure.py
}

# pictures VERSION: the cube in three pictures, in VTK and then in POV-Ray. vtk_python runs Python with that VTK.
pictures() {
  local expected picture in_vtk
  while IFS='|' read -r picture in_vtk expected; do
    seen "$picture, VTK $1" "$in_vtk" "$(vtk_python export.py $picture 2>log)"
    seen "$picture, POV-Ray" "$expected" "$(in_povray)"
  done <<'PICTURES'
perspective 200 200|39 by 39|40 by 40
perspective 400 200|39 by 39|78 by 40
parallel 400 200|100 by 100|74 by 38
PICTURES
}

unpack bookworm amd64 povray=1:3.7.0.10-2+b2 python3-vtk9=9.1.0+really9.1.0+dfsg2-5+deb12u1
root_pov=$root
vtk_python() { python "$@"; }
guess "39 by 39 or 40 by 40 in both pictures with perspective, and 100 by 100 with a parallel projection"
pictures 9.1.0
unpack trixie amd64 python3-vtk9=9.3.0+dfsg1-4+b1
vtk_python() { PYTHONHOME=$root/usr run "$root/usr/bin/python3.13" "$@"; }
pictures 9.3.0
finish
