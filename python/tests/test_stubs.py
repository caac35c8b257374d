"""The stubs say what the module has: no more, no less, with the same arguments."""

import ast
import inspect
from pathlib import Path

import cohelm._native as native

STUBS = ast.parse((Path(native.__file__).parent / "_native.pyi").read_text())


def arguments(function):
    spec = function.args
    names = [one.arg for one in spec.posonlyargs + spec.args + spec.kwonlyargs]
    return [name for name in names if name not in ("self", "cls")]


def test_every_class_and_function_has_its_stub_and_every_stub_its_class():
    stubbed = {node.name for node in STUBS.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
    there = {name for name in dir(native) if not name.startswith("_")}
    assert stubbed == there


def test_members_and_arguments_are_the_same():
    for node in STUBS.body:
        if isinstance(node, ast.FunctionDef):
            assert arguments(node) == list(inspect.signature(getattr(native, node.name)).parameters), node.name
        if isinstance(node, ast.ClassDef):
            check_class(node, getattr(native, node.name))


def check_class(node, there):
    members = {member.name: member for member in node.body if isinstance(member, ast.FunctionDef)}
    found = {name for name in vars(there) if not name.startswith("_")}
    assert {name for name in members if not name.startswith("_")} == found, node.name
    for name, member in members.items():
        is_property = any(isinstance(d, ast.Name) and d.id == "property" for d in member.decorator_list)
        if is_property or name.startswith("__copy") or name.startswith("__deep"):
            continue
        signature = inspect.signature(there if name == "__init__" else getattr(there, name))
        given = [parameter for parameter in signature.parameters if parameter not in ("self", "cls")]
        assert arguments(member) == given, f"{node.name}.{name}"
