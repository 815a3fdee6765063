"""VTK, or ParaView's VTK: its writers and readers of triangles."""
import json

import vtk

from house_json import BACK, OUT, attempt, house


def array(values, name, kind=vtk.vtkFloatArray):
    a = kind()
    a.SetName(name)
    a.SetNumberOfComponents(len(values[0]))
    for v in values:
        a.InsertNextTuple([255 * x + 0.5 for x in v] if kind is vtk.vtkUnsignedCharArray else v)
    return a


def build(faces=None):
    """All faces, or those of one material: a point for each corner."""
    points, cells, start = vtk.vtkPoints(), vtk.vtkCellArray(), 0
    for p in house["corner_positions"]:
        points.InsertNextPoint(p)
    for face, material in zip(house["faces"], house["face_materials"]):
        if faces is None or material == faces:
            cells.InsertNextCell(len(face))
            for k in range(len(face)):
                cells.InsertCellPoint(start + k)
        start += len(face)
    data = vtk.vtkPolyData()
    data.SetPoints(points)
    data.SetPolys(cells)
    data.GetPointData().SetNormals(array(house["corner_normals"], "Normals"))
    data.GetPointData().SetTCoords(array(house["corner_uvs"], "TCoords"))
    data.GetPointData().SetScalars(array(house["corner_srgb_colors"], "Colors", vtk.vtkUnsignedCharArray))
    return data


def triangulated(data):
    cut = vtk.vtkTriangleFilter()
    cut.SetInputData(data)
    cut.Update()
    return cut.GetOutput()


def window(colors=False):
    renderer, view = vtk.vtkRenderer(), vtk.vtkRenderWindow()
    view.SetOffScreenRendering(1)
    view.AddRenderer(renderer)
    for i, m in enumerate(house["materials"]):
        clean = vtk.vtkCleanPolyData()  # drops the points of the other material
        clean.PointMergingOff()
        clean.SetInputData(triangulated(build(i)))
        clean.Update()
        clean.GetOutput().GetPointData().GetNormals().SetName("NORMAL")  # which the exporter of glTF looks for
        mapper = vtk.vtkPolyDataMapper()
        mapper.SetInputData(clean.GetOutput())
        mapper.SetScalarVisibility(colors)
        actor = vtk.vtkActor()
        actor.SetMapper(mapper)
        actor.GetProperty().SetColor(m["color"])
        if m["texture"]:
            reader = vtk.vtkPNGReader()
            reader.SetFileName(OUT + m["texture"])
            reader.Update()
            texture = vtk.vtkTexture()
            texture.SetInputConnection(reader.GetOutputPort())
            actor.SetTexture(texture)
        renderer.AddActor(actor)
    view.Render()
    return view


def write(writer, name, data=None):
    writer.SetFileName(OUT + name)
    if data is not None:
        writer.SetInputData(data)
    writer.Write()


def ply(name, text):
    writer = vtk.vtkPLYWriter()
    writer.SetArrayName("Colors")
    writer.SetColorModeToDefault()
    writer.SetTextureCoordinatesNameToTextureUV()
    if text:
        writer.SetFileTypeToASCII()
    write(writer, name, triangulated(build()))


def exported(exporter, name, colors=False):
    exporter.SetRenderWindow(window(colors))
    if name.endswith(".obj"):
        exporter.SetFilePrefix(OUT + name[:-4])
    else:
        exporter.SetFileName(OUT + name)
        exporter.SetInlineData(True)
        exporter.SetSaveNormal(True)
    exporter.Write()


def dump(data, form):
    points, normals, uvs, colors = data.GetPoints(), data.GetPointData().GetNormals(), data.GetPointData().GetTCoords(), data.GetPointData().GetScalars()
    polygons = []
    for i in range(data.GetNumberOfCells()):
        ids = data.GetCell(i).GetPointIds()
        corners = []
        for k in range(ids.GetNumberOfIds()):
            v = ids.GetId(k)
            color = None
            if colors and colors.GetNumberOfComponents() >= 3:
                scale = 255 if colors.GetDataTypeAsString() == "unsigned char" else 1
                color = [x / scale for x in colors.GetTuple(v)[:3]]
            corners.append([points.GetPoint(v), normals.GetTuple(v) if normals else None, uvs.GetTuple(v)[:2] if uvs else None, color])
        polygons.append(corners)
    json.dump({"vertices": points.GetNumberOfPoints(), "polygons": polygons}, open("%sread_%s.json" % (OUT, form), "w"))


def read(reader, form):
    reader.SetFileName("%shouse.%s" % (BACK, form))
    reader.Update()
    data = reader.GetOutput()
    if data.IsA("vtkMultiBlockDataSet"):
        flat = vtk.vtkCompositeDataGeometryFilter()
        flat.SetInputData(data)
        flat.Update()
        data = flat.GetOutput()
    dump(data, form)


print(vtk.vtkVersion.GetVTKVersion())
attempt("obj", lambda: exported(vtk.vtkOBJExporter(), "house.obj"))
attempt("obj", lambda: write(vtk.vtkOBJWriter(), "writer.obj", build()))
attempt("ply", lambda: ply("house.ply", False))
attempt("ply", lambda: ply("text.ply", True))
attempt("stl", lambda: write(vtk.vtkSTLWriter(), "house.stl", triangulated(build())))
attempt("gltf", lambda: exported(vtk.vtkGLTFExporter(), "house.gltf"))
attempt("gltf", lambda: exported(vtk.vtkGLTFExporter(), "colors.gltf", True))
for form, reader in (("obj", vtk.vtkOBJReader), ("ply", vtk.vtkPLYReader), ("stl", vtk.vtkSTLReader), ("glb", vtk.vtkGLTFReader)):
    attempt("read " + form, lambda: read(reader(), form))
