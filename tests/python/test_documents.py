"""The examples of docs/python.md run, and what they print is there; stubs name what there is."""

import ast
import os
import re
from pathlib import Path

import oktett
from oktett import _oktett

SOURCE = Path(os.environ.get("OKTETT_SOURCE_DIR", Path(__file__).parents[2]))


def test_the_examples_run_in_their_order():
    blocks = re.findall(r"```python\n(.*?)```", (SOURCE / "docs/python.md").read_text(), re.S)
    assert len(blocks) > 4
    exec(compile("\n".join(blocks), "docs/python.md", "exec"), {})


def test_stubs_and_module_name_the_same():
    stub = ast.parse((Path(oktett.__file__).parent / "_oktett.pyi").read_text())
    functions = {node.name for node in stub.body if isinstance(node, ast.FunctionDef)}
    assert functions == {name for name in dir(_oktett) if not name.startswith("_") and name != "Scene"}
    (scene,) = (node for node in stub.body if isinstance(node, ast.ClassDef))
    methods = {node.name: node for node in scene.body if isinstance(node, ast.FunctionDef)}
    public = {name for name in dir(oktett.Scene) if not name.startswith("_")} | {"_repr_png_"}
    assert set(methods) - {"__init__"} == public
    for name, method in methods.items():
        documentation = getattr(oktett.Scene, name).__doc__
        assert documentation and len(documentation) > 20, name
        if isinstance(getattr(oktett.Scene, name), property):
            continue
        # The first line is the signature that pybind11 writes.
        signature = documentation.splitlines()[0]
        arguments = [a.arg for a in method.args.args + method.args.kwonlyargs if a.arg != "self"]
        assert re.findall(r"(\w+)(?=:)", re.sub(r"'[^']*'|<[^>]*>|\[[^][]*\]", "", signature.split(" -> ")[0]))[-len(arguments) or 99 :] == arguments, signature
