"""Everything public is documented, in `help` as in the stub, and the stub is what there is."""

import ast
import inspect
import pathlib
import subprocess
import sys

import saturated_hybrid as sh
from saturated_hybrid import _core, actions, environment, episodes, rotorpy, tasks, textbook

STUB = ast.parse((pathlib.Path(_core.__file__).parent / "_core.pyi").read_text())


def documented():
    """The stub's names with their docstrings: classes, functions, methods and properties."""
    for node in STUB.body:
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            yield node.name, getattr(_core, node.name), ast.get_docstring(node)
            for member in node.body:
                if isinstance(member, ast.FunctionDef) and not member.name.startswith("__"):
                    yield f"{node.name}.{member.name}", getattr(getattr(_core, node.name), member.name), ast.get_docstring(member)
        elif isinstance(node, ast.FunctionDef):
            yield node.name, getattr(_core, node.name), ast.get_docstring(node)


def test_help_says_what_the_stub_says():
    found = list(documented())
    assert len(found) > 100
    assert not [name for name, _, doc in found if not doc]
    # Each is folded in its own way.
    unlike = [name for name, thing, doc in found if inspect.getdoc(thing).split() != doc.split()]
    assert not unlike


def test_the_stub_has_everything_and_nothing_else():
    named = {name for name, *_ in documented()}
    there = {name for name in dir(_core) if not name.startswith("_")}
    for kind in [name for name in there if inspect.isclass(getattr(_core, name))]:
        there |= {f"{kind}.{member}" for member in vars(getattr(_core, kind)) if not member.startswith("_")}
    assert named == there
    assert set(sh.__all__) == {name for name in there if "." not in name}


def test_python_parts_are_documented_too():
    modules = (actions, environment, episodes, rotorpy, tasks, textbook)
    assert all(module.__doc__ for module in modules)
    classes = (environment.Task, environment.Environment, environment.VectorEnvironment, rotorpy.SaturatedHybridControl, textbook.Textbook)
    for part in classes + (tasks.Hover, tasks.HoverRows, tasks.Gate, tasks.GateRows):
        assert part.__doc__
        for name, member in vars(part).items():
            assert name.startswith("_") or not callable(member) or member.__doc__, (part, name)


def test_types_are_there_for_checkers_and_right():
    assert (pathlib.Path(_core.__file__).parent / "py.typed").exists()
    checked = [sys.executable, "-m", "mypy.stubtest", "--concise", "--ignore-disjoint-bases", "saturated_hybrid._core"]
    done = subprocess.run(checked, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
