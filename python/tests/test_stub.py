"""The stub of the extension module has the module's names, and help() has a text for each public one."""

import ast
import inspect
import pathlib

import relume
from relume import _core, _parts

STUB = ast.parse((pathlib.Path(relume.__file__).parent / "_core.pyi").read_text(encoding="utf-8"))
CLASSES = {node.name: node for node in STUB.body if isinstance(node, ast.ClassDef)}


def names(body, kind):
    return [node.name for node in body if isinstance(node, kind)]


def public(names_of_module):
    return {name for name in names_of_module if not name.startswith("_")}


def test_functions_and_classes_are_those_of_the_module():
    found = {name: value for name, value in vars(_core).items() if not name.startswith("_")}
    assert set(CLASSES) == {name for name, value in found.items() if inspect.isclass(value)}
    assert set(names(STUB.body, ast.FunctionDef)) == {name for name, value in found.items() if not inspect.isclass(value)}


def test_attributes_are_those_of_the_parts():
    for kind in _parts.TYPES:
        body = CLASSES[kind.__name__].body
        attributes = [node.target.id for node in body if isinstance(node, ast.AnnAssign)]
        assert sorted(attributes) == sorted(_parts.names(kind)), kind
        (constructor,) = (node for node in body if isinstance(node, ast.FunctionDef) and node.name == "__init__")
        assert [argument.arg for argument in constructor.args.kwonlyargs] == attributes, kind


def test_methods_are_those_of_the_classes():
    for name in ("SessionCore", "SettingsCore"):
        assert public(names(CLASSES[name].body, ast.FunctionDef)) == public(vars(getattr(_core, name))), name


def test_all_public_names_have_a_description():
    for name in relume.__all__:
        value = getattr(relume, name)
        if not inspect.ismodule(value) and (callable(value) or inspect.isclass(value)):
            assert inspect.getdoc(value), name
        members = {member: each for member, each in vars(value).items() if public([member])} if inspect.isclass(value) else {}
        for member, each in members.items():
            if member != "name" and (isinstance(each, property) or callable(each)):
                assert (each.__doc__ or "").strip(), f"{name}.{member}"
