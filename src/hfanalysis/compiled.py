"""Compiled code: one way to decorate it, a cache that is never stale, and code that is compiled once and called by
address.

numba keeps compiled functions beside their sources and takes them up again as long as their own file is as old as it
was. It does not look at what they call from other files. Here a function is taken up only while its module *and every
module of the package that it imports, directly or not*, read as they did; how old files are does not matter.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar, overload

from numba import njit, types
from numba.core import cgutils
from numba.core.ccallback import CFunc
from numba.core.typing.templates import Signature
from numba.extending import intrinsic, register_jitable
from numba.np import linalg

from hfanalysis.sources import source_digest

Function = TypeVar("Function", bound=Callable[..., Any])

Real = Any
"""A number, or an array of them: what a :func:`law` is given and gives."""


def _load_before_scipy() -> None:
    """numba looks for SciPy at its first function, which takes a tenth of a second.

    Compiled code that multiplies matrices still has it looked for.
    """
    looked_for = linalg.ensure_blas
    linalg.ensure_blas = lambda: None
    try:
        from numba.np import arraymath  # noqa: F401
    finally:
        linalg.ensure_blas = looked_for


_load_before_scipy()


@overload
def compiled(function: Function) -> Function: ...


@overload
def compiled(function: None = None, **options: Any) -> Callable[[Function], Function]: ...


def compiled(function: Callable[..., Any] | None = None, **options: Any) -> Any:
    """``numba.njit`` with IEEE division and the cache of this module; ``options`` as numba's."""
    if function is None:
        return lambda f: _compiled(f, **options)
    return _compiled(function, **options)


def _compiled(function: Callable[..., Any], **options: Any) -> Any:
    made = njit(error_model="numpy", **options)(function)
    made.enable_caching()
    _stamp(made, function)
    return made


def inner(function: Function) -> Function:
    """As :func:`compiled`, but only for compiled callers: spares the time that what Python needs takes to compile."""
    made: Function = _compiled(function, no_cpython_wrapper=True, no_cfunc_wrapper=True)
    return made


def inlined(function: Function) -> Function:
    """As :func:`inner`, always merged into its callers: for the small pieces of what is called most."""
    made: Function = _compiled(function, forceinline=True, no_cpython_wrapper=True, no_cfunc_wrapper=True)
    return made


def law(function: Function) -> Function:
    """A formula for numbers and arrays alike: plain Python by itself, and part of the compiled code that calls it."""
    made: Function = register_jitable(error_model="numpy")(function)
    return made


class Callback:
    """A function with a C signature, compiled when its ``address`` is first asked for."""

    def __init__(self, function: Callable[..., Any], signature: Signature) -> None:
        self.function, self.signature = function, signature
        self.__doc__ = function.__doc__

    @cached_property
    def made(self) -> Any:
        """numba's own object for it."""
        made = CFunc(self.function, (self.signature.args, self.signature.return_type), {}, {"error_model": "numpy"})
        made.enable_caching()
        _stamp(made, self.function)
        made.compile()
        return made

    @property
    def address(self) -> int:
        """Where its machine code is."""
        address: int = self.made.address
        return address

    @property
    def ctypes(self) -> Any:
        """For calls from Python."""
        return self.made.ctypes


class Separate:
    """A compiled function that returns nothing, compiled once for one signature and called through its address.

    numba merges what a function calls into it and optimizes it anew in every caller; what is large and called from
    several places is spared that. Compiled code calls it by :func:`caller`, Python the object itself.
    """

    def __init__(self, function: Callable[..., Any], signature: Signature) -> None:
        self._made = _compiled(function)
        self.signature, self.__doc__ = signature, function.__doc__

    @cached_property
    def address(self) -> int:
        """Where its machine code is."""
        self._made.compile(self.signature)
        found = self._made.overloads[tuple(self.signature.args)]
        return int(found.library.get_pointer_to_function(found.fndesc.llvm_func_name))

    def __call__(self, *args: Any) -> None:
        self._made(*args)


def separate(signature: Signature) -> Callable[[Callable[..., Any]], Separate]:
    """Decorator for :class:`Separate`."""
    return lambda function: Separate(function, signature)


def caller(expected: Signature) -> Any:
    """What calls functions of a signature in compiled code: ``call(address, …)``."""

    @intrinsic
    def call(_typing: Any, address: Any, *args: Any) -> Any:
        signature = types.none(types.int64, types.StarArgTuple(expected.args))  # type: ignore[no-untyped-call]

        def generate(context: Any, builder: Any, _sig: Any, values: Any) -> Any:
            kind = context.call_conv.get_function_type(types.none, expected.args)
            function = builder.inttoptr(values[0], kind.as_pointer())
            unpacked = cgutils.unpack_tuple(builder, values[1])  # type: ignore[no-untyped-call]
            context.call_conv.call_function(builder, function, types.none, expected.args, unpacked)
            return context.get_dummy_value()

        return signature, generate

    return call


def by_address(kind: Any) -> tuple[Any, Any]:
    """``address_of(value)`` and ``at(address)`` for tuples of numbers and arrays of the numba type ``kind``.

    Large tuples are passed on as one number. The address holds while the function runs that asked for it; what comes
    back owns no array, so that nothing is counted.
    """

    @intrinsic
    def address_of(_typing: Any, _value: Any) -> Any:
        def generate(_context: Any, builder: Any, _signature: Any, values: Any) -> Any:
            place = cgutils.alloca_once_value(builder, values[0])  # type: ignore[no-untyped-call]
            return builder.ptrtoint(place, cgutils.intp_t)

        return types.int64(kind), generate

    @intrinsic
    def at(_typing: Any, _address: Any) -> Any:
        def generate(context: Any, builder: Any, _signature: Any, values: Any) -> Any:
            place = builder.inttoptr(values[0], context.get_value_type(kind).as_pointer())
            return _borrowed(context, builder, kind, builder.load(place))

        return kind(types.int64), generate

    return address_of, at


def _borrowed(context: Any, builder: Any, kind: Any, value: Any) -> Any:
    """A value whose arrays nobody owns."""
    if isinstance(kind, types.Array):
        array = context.make_array(kind)(context, builder, value)
        null: Any = cgutils.get_null_value
        array.meminfo, array.parent = null(array.meminfo.type), null(array.parent.type)
        return array._getvalue()
    if isinstance(kind, types.BaseTuple):
        parts: tuple[Any, ...] = tuple(kind)  # type: ignore[arg-type]
        for i, part in enumerate(parts):
            inner = _borrowed(context, builder, part, builder.extract_value(value, i))
            value = builder.insert_value(value, inner, i)
    return value


def _stamp(made: Any, function: Callable[..., Any]) -> None:
    """Let numba's cache compare sources instead of the age of one of them, and pass over one that cannot be read."""
    index = made._cache._cache_file
    if not (hasattr(index, "_source_stamp") and hasattr(index, "_load_index")):
        raise RuntimeError("this version of numba keeps its cache in another way; hfanalysis.compiled does not know it")
    index._source_stamp = source_digest(Path(function.__code__.co_filename), inside=False)
    index._load_index = _readable(index._load_index)


def _readable(load: Callable[[], dict[Any, Any]]) -> Callable[[], dict[Any, Any]]:
    """What a cache holds; nothing where it is damaged, or names modules that are no longer there."""

    def loaded() -> dict[Any, Any]:
        try:
            return load()
        except Exception:  # unpickling raises whatever it meets
            return {}

    return loaded
