"""The programs that scripts/interop runs: the package, the releases that have it, and a command, which writes files to
$OUT and leaves what it has read of $BACK there as read_FORMAT.json or as a file of another format."""

from dataclasses import dataclass

BOTH = ("bookworm", "trixie")


@dataclass
class Program:
    name: str
    package: str
    command: str
    suites: tuple = BOTH


BASE_PACKAGES = ["bash", "coreutils", "dash", "diffutils", "findutils", "grep", "gzip", "libc-bin", "mawk", "sed", "util-linux", "xauth",
                 "xvfb"]
DEBIAN = [
    Program("Blender", "blender", "blender --background --factory-startup -noaudio --python /programs/use_blender.py"),
    Program("VTK", "python3-vtk9", "xvfb-run -a python3 /programs/use_vtk.py"),
    Program("Open3D", "python3-open3d", "python3 /programs/use_open3d.py"),
    Program("trimesh", "python3-trimesh", "python3 /programs/use_trimesh.py", ("trixie",)),
    Program("meshio", "python3-meshio", "python3 /programs/use_meshio.py"),
    Program("Assimp", "assimp-utils", "bash /programs/assimp.sh"),
    Program("MeshLab", "meshlab", "bash /programs/meshlab.sh", ("bookworm",)),
    Program("CloudCompare", "cloudcompare", "bash /programs/cloudcompare.sh"),
    Program("FreeCAD", "freecad-python3", "python3 /programs/use_freecad.py"),
    Program("Gmsh", "python3-gmsh", "python3 /programs/use_gmsh.py"),
    Program("OpenSceneGraph", "openscenegraph", "bash /programs/osgconv.sh"),
    Program("OpenSCAD", "openscad", "bash /programs/openscad.sh"),
    Program("PCL", "pcl-tools", "bash /programs/pcl.sh"),
    Program("PrusaSlicer", "prusa-slicer", "bash /programs/slicer.sh"),
    Program("Draco", "draco", "bash /programs/draco.sh"),
    Program("OpenCTM", "openctm-tools", "bash /programs/openctm.sh"),
    Program("ezdxf", "python3-ezdxf", "python3 /programs/use_ezdxf.py"),
    Program("tinyobjloader", "python3-tinyobjloader", "python3 /programs/use_tinyobjloader.py"),
    Program("numpy-stl", "python3-stl", "python3 /programs/use_numpy_stl.py"),
    Program("ADMesh", "admesh", "bash /programs/admesh.sh"),
]
NPM_PACKAGES = [
    "three@0.187.0", "@gltf-transform/core@4.5.1", "@gltf-transform/functions@4.5.1", "@gltf-transform/extensions@4.5.1", "obj2gltf@3.2.0",
    "gltf-pipeline@4.3.1", "@babylonjs/core@9.35.0", "@babylonjs/serializers@9.28.0", "assimpjs@0.0.10", "@loaders.gl/core@4.4.5",
    "@loaders.gl/ply@4.4.5", "@loaders.gl/obj@4.4.5", "gltf-validator@2.0.0-dev.3.10", "gltfpack@1.3.0", "@jscad/modeling@2.13.0",
    "@jscad/stl-serializer@2.1.23", "@jscad/obj-serializer@2.1.23",
]
NPM = [
    Program("three.js", "three", "node use_three.mjs"),
    Program("Babylon.js", "@babylonjs/serializers", "node use_babylon.mjs"),
    Program("glTF-Transform", "@gltf-transform/core", "node use_gltf_transform.mjs"),
    Program("obj2gltf", "obj2gltf", "node use_obj2gltf.mjs"),
    Program("gltf-pipeline", "gltf-pipeline", "node use_gltf_pipeline.mjs"),
    Program("gltfpack", "gltfpack", "bash gltfpack.sh"),
    Program("assimpjs", "assimpjs", "node use_assimpjs.mjs"),
    Program("loaders.gl", "@loaders.gl/ply", "node use_loaders_gl.mjs"),
    Program("JSCAD", "@jscad/modeling", "node use_jscad.mjs"),
    Program("Khronos validator", "gltf-validator", "node use_validator.mjs"),
]
