"""The identity of a user's function: a digest of the code that runs, not of a file's text."""

from __future__ import annotations

import collections
import datetime
import functools
import hashlib
import numbers
import pathlib
import sys
import types
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from beammodes.checks import shown

__all__ = ["check_running_code", "running_code"]

_PLAIN = (type(None), type(...), bool, int, float, complex, str, bytes, range)

# What Python itself puts into a class; a class's text can be the same where these differ.
_MACHINERY = {
    *("__dict__", "__weakref__", "__doc__", "__module__", "__firstlineno__", "__static_attributes__"),
    *("__annotations__", "__annotate_func__", "__annotations_cache__", "__conditional_annotations__"),
    "__classdictcell__",
}

# Of a code object's flags those above are of `from __future__ import`, which the bytecode shows itself.
_FLAGS = 0xFFFF


# Sources of functions that were found to be the same in this process.
_CHECKED: set[tuple[tuple[str, str], ...]] = set()


def running_code(function: types.FunctionType) -> dict[str, str]:
    """Return digests of the code and values that a function consists of as it runs here, by name.

    Covered are the function's bytecode, constants, defaults and closure, and the same of every function,
    method and class of the user's that it names, wherever they were typed; the values of the global names
    that these read: numbers, text, dates, paths, arrays, containers and objects with attributes of these;
    modules of the user's, by the names taken from them; the versions of Python and of libraries. Bytecode is
    that of one version of Python.

    Not covered is what no name in the code leads to: files and the network, names looked up as text, the
    state of random generators, of other objects that are not written in Python and of those of the standard
    library, and the settings of libraries.

    Raises
    ------
    ValueError
        If the values are nested too deep.

    Examples
    --------
    >>> def double(case):
    ...     return 2.0 * case.segments
    >>> def own(case):
    ...     return double(case) + 1.0
    >>> before = running_code(own)
    >>> def double(case):
    ...     return 3.0 * case.segments
    >>> [name.rpartition(".")[2] for name, digest in running_code(own).items() if before[name] != digest]
    ['double']
    """
    gathered = _Gathered()
    try:
        gathered.function(function)
    except RecursionError:
        raise ValueError(
            f"compute must be functions whose globals are not nested that deep, got {shown(function)}"
        ) from None
    found = {name: _hashed(parts) for name, parts in gathered.parts.items()}
    python = ".".join(map(str, sys.version_info[:2]))
    return dict(sorted(found.items())) | {"python": python} | dict(sorted(gathered.versions.items()))


def check_running_code(function: types.FunctionType, source: Mapping[str, str]) -> None:
    """Raise ValueError if a user's function is not, in this process, the code that the study was made of.

    What a worker loads from a module may be another text by now, or lack a value set since. Looked at once in
    a process: while it works, a function may change what it remembers.
    """
    known = tuple(source.items())
    if known in _CHECKED:
        return
    here = running_code(function)
    for name in {**source, **here}:
        # What stands in no module's file is sent along with the function.
        if not name.startswith("__main__.") and source.get(name) != here.get(name):
            raise ValueError(
                f"workers must have {name} as it was when the study was made, got another: "
                f"{source.get(name)} there, {here.get(name)} here"
            )
    _CHECKED.add(known)


def _hashed(parts: Iterable[str]) -> str:
    return hashlib.sha256("\0".join(parts).encode("utf-8", "surrogatepass")).hexdigest()[:16]


@dataclass
class _Gathered:
    """Descriptions by name, versions of libraries, and the objects met so far, kept alive."""

    parts: dict[str, list[str]] = field(default_factory=dict)
    versions: dict[str, str] = field(default_factory=dict)
    met: dict[int, tuple[str, object]] = field(default_factory=dict)

    def function(self, function: types.FunctionType) -> str:
        """Describe a function under its name, and return the name."""
        name, parts = self._place(function, f"{function.__module__}.{function.__qualname__}")
        cells = []
        for cell in function.__closure__ or ():
            try:
                cells.append(cell.cell_contents)
            except ValueError:
                cells.append("a name that has no value yet")
        parts += self._code(function.__code__)
        parts += map(self.value, (function.__defaults__, function.__kwdefaults__, *cells))
        names = set(_names(function.__code__))
        for word in sorted(names & function.__globals__.keys()):
            self._global(f"{function.__module__}.{word}", function.__globals__[word], names)
        return name

    def value(self, value: object) -> str:
        """Return a description of a value; what is met again is described by its name alone."""
        if isinstance(value, _PLAIN):
            # Python refuses to print an integer of very many digits, but not in hexadecimal.
            text = f"{int(value):x}" if isinstance(value, int) else repr(value)
            return f"{type(value).__name__} {text}"
        if id(value) in self.met:
            return self.met[id(value)][0]
        library = self._library(value)
        if library:
            return library
        if isinstance(value, types.FunctionType):
            return self.function(value)
        if isinstance(value, type):
            return self._class(value)
        if not isinstance(value, tuple | frozenset | np.generic):
            # Of these a program may hold one or several alike: no part of its meaning.
            self.met[id(value)] = (f"number {len(self.met)}", value)
        return f"{type(value).__name__} {_hashed(self._contents(value))}"

    def _place(self, value: object, name: str) -> tuple[str, list[str]]:
        """Take a name that is free, and remember that it stands for this object."""
        number, free = 1, name
        while free in self.parts:
            number += 1
            free = f"{name} {number}"
        self.met[id(value)] = (free, value)
        self.parts[free] = []
        return free, self.parts[free]

    def _code(self, code: types.CodeType) -> Iterator[str]:
        counts = code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount, code.co_flags & _FLAGS
        yield f"{code.co_name} {counts} {code.co_code.hex()} {getattr(code, 'co_exceptiontable', b'').hex()}"
        yield f"{code.co_names} {code.co_varnames} {code.co_freevars} {code.co_cellvars}"
        for constant in code.co_consts:
            if isinstance(constant, types.CodeType):
                yield from self._code(constant)
            else:
                yield self.value(constant)

    def _global(self, name: str, value: object, names: set[str]) -> None:
        """Describe what a global name means, under that name unless it has one of its own."""
        if isinstance(value, types.ModuleType) and not self._library(value):
            for word in sorted(names & vars(value).keys()):
                self._global(f"{value.__name__}.{word}", vars(value)[word], names)
        elif isinstance(value, types.FunctionType | type | types.ModuleType):
            self.value(value)
        elif name not in self.parts:
            self.parts[name] = []
            self.parts[name].append(self.value(value))

    def _class(self, value: type) -> str:
        name, parts = self._place(value, f"{value.__module__}.{value.__qualname__}")
        parts += map(self.value, value.__bases__)
        for word, item in sorted(vars(value).items()):
            if word not in _MACHINERY:
                parts.append(f"{word} {self.value(item)}")
        return name

    def _contents(self, value: object) -> Iterator[str]:
        """Yield the parts of what is neither plain, nor a function or class."""
        inner: Iterable[Any] = ()
        if isinstance(value, np.ndarray | np.generic):
            array = np.asarray(value)
            yield f"{array.dtype.str} {array.shape}"
            if array.dtype.hasobject:
                inner = array.ravel().tolist()
            else:
                yield hashlib.sha256(array.tobytes()).hexdigest()
        elif isinstance(value, set | frozenset):
            yield from sorted(map(self.value, value))
        elif isinstance(value, dict | types.MappingProxyType):
            inner = (part for pair in value.items() for part in pair)
        elif isinstance(value, list | tuple | collections.deque):
            inner = value
        elif isinstance(value, types.MethodType):
            inner = (value.__func__, value.__self__)
        elif isinstance(value, functools.partial):
            inner = (value.func, value.args, value.keywords)
        elif isinstance(value, staticmethod | classmethod):
            inner = (value.__func__,)
        elif isinstance(value, property):
            inner = (value.fget, value.fset, value.fdel)
        elif isinstance(value, functools._lru_cache_wrapper):
            inner = (value.__wrapped__,)  # its memory is no part of its meaning
        elif isinstance(value, numbers.Number | pathlib.PurePath | datetime.date | datetime.timedelta):
            yield repr(value)
        else:
            # A logger, an open file: what such an object of Python's own holds differs from run to run.
            state = (
                {} if type(value).__module__.partition(".")[0] in sys.stdlib_module_names else _state(value)
            )
            inner = (type(value), state)
        yield from map(self.value, inner)

    def _library(self, value: object) -> str:
        """Return what names a module, function or class of a library, and nothing for the user's own."""
        module = value if isinstance(value, types.ModuleType) else sys.modules.get(_module_of(value))
        if not isinstance(module, types.ModuleType) or not _is_library(module):
            return ""
        if isinstance(value, types.FunctionType) and value.__globals__ is not vars(module):
            return ""  # typed elsewhere, under a library's name
        top = module.__name__.partition(".")[0]
        version = getattr(sys.modules.get(top), "__version__", None)
        if isinstance(version, str):
            self.versions[top] = version
        own = "" if module is value else getattr(value, "__qualname__", type(value).__qualname__)
        return f"{module.__name__} {own}"


def _names(code: types.CodeType) -> Iterator[str]:
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            yield from _names(constant)


def _state(value: object) -> dict[str, Any]:
    """Return an object's attributes."""
    slots = (word for kind in type(value).__mro__ for word in _words(vars(kind).get("__slots__", ())))
    held = {word: getattr(value, word) for word in slots if hasattr(value, word) and word not in _MACHINERY}
    return held | dict(getattr(value, "__dict__", {}))


def _words(slots: Any) -> tuple[str, ...]:
    return (slots,) if isinstance(slots, str) else tuple(slots)


def _module_of(value: object) -> str:
    callables = (types.FunctionType, types.BuiltinFunctionType, type, np.ufunc)
    found = getattr(value, "__module__", None) if isinstance(value, callables) else None
    if isinstance(value, np.ufunc):
        return "numpy"
    return found if isinstance(found, str) else ""


def _is_library(module: types.ModuleType) -> bool:
    top = module.__name__.partition(".")[0]
    file = getattr(module, "__file__", None)
    if top == "__main__":
        return False
    installed = isinstance(file, str) and ("site-packages" in file or "dist-packages" in file)
    return top == __name__.partition(".")[0] or top in sys.stdlib_module_names or installed
