"""stub.py PACKAGE STUB: writes the package's type stub, with the options that the module in the folder PACKAGE has.

The functions are read from their source, since importing the package needs numpy, which a build does without.
"""

import ast
import pathlib
import sys

package, stub = sys.argv[1:3]
sys.path.insert(0, package)
import _options  # noqa: E402

_VALUES = {"flag": "bool", "integer": "int", "number": "float", "length": "float | str", "file": "str | PathLike[str]"}

_HEAD = '''# Made by stub.py from the table of the command's options.
from collections.abc import Callable, Sequence
from os import PathLike
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__: list[str]
__version__: str

_Progress = bool | Callable[[str, float], object] | None
_Config = dict[str, Any] | str | PathLike[str] | None
_Report = dict[str, Any]

class Error(Exception):
    code: str
    place: str | None
    def __init__(self, code: str, message: str) -> None: ...

class Mesh(NamedTuple):
    vertices: NDArray[Any]
    faces: NDArray[np.uint32]
    edges: NDArray[np.uint32]
    kinds: NDArray[np.uint8] | None = ...

class Cloud:
    @property
    def fields(self) -> list[tuple[str, str, int]]: ...
    @property
    def format(self) -> str: ...
    @property
    def encoding(self) -> str: ...
    @property
    def extent(self) -> tuple[int, int]: ...
    @property
    def viewpoint(self) -> str: ...
    @viewpoint.setter
    def viewpoint(self, viewpoint: str, /) -> None: ...
    def __len__(self) -> int: ...
    def positions(self) -> NDArray[np.float64]: ...
    def faces(self) -> NDArray[np.uint32]: ...
    def edges(self) -> NDArray[np.uint32]: ...
'''

# What the functions' own parameters and results are.
_TYPES = {
    "points": "ArrayLike",
    "array": "NDArray[Any]",
    "vertices": "ArrayLike",
    "faces": "ArrayLike",
    "truth": "ArrayLike",
    "normals": "ArrayLike | None",
    "truth_normals": "ArrayLike | None",
    "signed_normals": "bool",
    "viewpoint": "Sequence[float] | None",
    "threads": "int",
    "progress": "_Progress",
    "config": "_Config",
    "path": "str | PathLike[str]",
    "file": "Cloud | None",
    "format": "str | None",
    "encoding": "str | None",
    "force": "bool",
    "drop_unsupported": "bool",
    "scale": "float | None",
}
_EXCEPTIONS = {("compare", "faces"): "ArrayLike | None", ("info", "points"): "ArrayLike | str | PathLike[str]"}
_RESULTS = {
    "denoise": "tuple[NDArray[Any], _Report]",
    "denoise_structured": "tuple[NDArray[Any], _Report]",
    "mesh": "tuple[Mesh, _Report]",
    "smooth_mesh": "tuple[Mesh, _Report]",
    "reconstruct": "tuple[Mesh, _Report]",
    "compare": "tuple[NDArray[np.float64], _Report]",
    "normals": "tuple[NDArray[np.float64], _Report]",
    "info": "_Report",
    "read": "tuple[NDArray[Any], Cloud]",
    "write": "None",
}


def type_of(entry):
    """What may be given for an option."""
    if entry["choices"]:
        text = "Literal[" + ", ".join(f'"{choice}"' for choice in entry["choices"]) + "]"
    elif entry["kind"] == "word":  # a field, a point
        text = "str | ArrayLike"
    else:
        text = _VALUES[entry["kind"]]
    return text + (" | None" if entry["optional"] else "")


def options_of(command):
    """The options of a sub-command as parameters."""
    table = _options.Table(command)
    for parameter in table.parameters():
        yield f"{parameter.name}: {type_of(table.entries[parameter.name])} = {parameter.default!r}"


def own(name, argument, default):
    """A parameter that the source has."""
    text = f"{argument.arg}: {_EXCEPTIONS.get((name, argument.arg), _TYPES[argument.arg])}"
    return text if default is None else f"{text} = {ast.unparse(default)}"


def signature(function):
    """A function as the stub has it."""
    name, arguments = function.name, function.args
    missing = [None] * (len(arguments.args) - len(arguments.defaults))
    parameters = [own(name, a, d) for a, d in zip(arguments.args, missing + arguments.defaults)]
    if arguments.kwonlyargs:
        parameters.append("*")
    for decorator in function.decorator_list:
        parameters.extend(options_of(ast.literal_eval(decorator.args[0])))
    parameters.extend(own(name, a, d) for a, d in zip(arguments.kwonlyargs, arguments.kw_defaults))
    lines = "".join(f"    {parameter},\n" for parameter in parameters)
    return f"def {name}(\n{lines}) -> {_RESULTS[name]}: ...\n"


source = ast.parse(pathlib.Path(package, "_functions.py").read_text(encoding="utf-8"))
functions = [node for node in source.body if isinstance(node, ast.FunctionDef) and node.name in _RESULTS]
pathlib.Path(stub).write_text(_HEAD + "\n" + "".join(signature(f) for f in functions), encoding="utf-8")
