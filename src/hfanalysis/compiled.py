"""Compiled code: one way to decorate it, a cache that is never stale, and code that is compiled once and called by
address.

numba keeps compiled functions beside their sources and takes them up again as long as their own file is as old as it
was. It does not look at what they call from other files. Here a function is taken up only while its module *and every
module of the package that it imports, directly or not*, read as they did; how old files are does not matter.
"""

from __future__ import annotations

import pickle
import stat
from collections.abc import Callable
from contextlib import suppress
from functools import cached_property, partial
from hashlib import sha256
from pathlib import Path
from typing import Any, TypeVar, overload

from numba import config, njit, types
from numba.core import cgutils
from numba.core.ccallback import CFunc
from numba.core.runtime.nrt import rtsys
from numba.core.typing.templates import Signature
from numba.extending import intrinsic, register_jitable

from hfanalysis.progress import compiling
from hfanalysis.sources import source_digest
from hfanalysis.users import own_temporary, user

Function = TypeVar("Function", bound=Callable[..., Any])

_SEAL = 32
"""Length of a SHA-256 [B]. Source: definition."""

Real = Any
"""A number, or an array of them: what a :func:`law` is given and gives."""


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
    _keep(made, function)
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
        _keep(made, self.function)
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


def _keep(made: Any, function: Callable[..., Any]) -> None:
    """Have compiled code kept from run to run, in a folder for temporary files where no other can be written to; where
    that cannot be either, it is compiled by each run."""
    try:
        made.enable_caching()
    except RuntimeError:  # numba found no folder
        folder = _private_folder()
        if folder is None:
            return
        config.CACHE_DIR = str(folder)  # type: ignore[attr-defined]
        made.enable_caching()
    _stamp(made, function)


def _private_folder() -> Path | None:
    """A folder that only this user can write to, for what is loaded from it is run; None where there is none."""
    try:
        folder, number = own_temporary(), user()
        folder.mkdir(mode=0o700, exist_ok=True)
        found = folder.lstat()
    except OSError:
        return None
    own = stat.S_ISDIR(found.st_mode) and (number is None or (found.st_uid == number and not found.st_mode & 0o022))
    return folder if own else None


def _stamp(made: Any, function: Callable[..., Any]) -> None:
    """Let numba's cache compare sources instead of the age of one of them, and pass over what is damaged or cannot be
    written."""
    cache = made._cache
    index = cache._cache_file
    known = ("_source_stamp", "_load_index", "_load_data", "_save_data", "_dump", "_data_path", "_open_for_write")
    if not all(hasattr(index, name) for name in known) or not hasattr(cache, "_load_overload"):
        raise RuntimeError("this version of numba keeps its cache in another way; hfanalysis.compiled does not know it")
    index._source_stamp = source_digest(Path(function.__code__.co_filename), inside=False)
    index._load_index = _readable(index._load_index)
    index._save_data, index._load_data = partial(_seal, index), partial(_unseal, index)
    cache.save_overload = _if_possible(cache.save_overload)
    cache.load_overload = partial(_kept, cache)


def _kept(cache: Any, signature: Any, context: Any) -> Any:
    """What is kept for a signature. numba loads all that compiling may need before it looks, for a quarter of a second;
    what is compiled asks for its memory management alone, and a compiler that starts for what is not kept loads the
    rest by itself."""
    rtsys.initialize(context)
    found = None
    with cache._guard_against_spurious_io_errors():
        found = cache._load_overload(signature, context)
    if found is None:
        compiling()
    return found


def _seal(index: Any, name: str, data: Any) -> None:
    """Write machine code behind its own SHA-256: run from a damaged file it ends in anything."""
    content = index._dump(data)
    with index._open_for_write(index._data_path(name)) as file:
        file.write(sha256(content).digest())
        file.write(content)


def _unseal(index: Any, name: str) -> Any:
    """What :func:`_seal` wrote; raises OSError, at which numba compiles anew, where it is that no more."""
    content = Path(index._data_path(name)).read_bytes()
    seal, content = content[:_SEAL], content[_SEAL:]
    if sha256(content).digest() != seal:
        raise OSError(f"{name} is damaged")
    return pickle.loads(content)


def _if_possible(save: Callable[..., None]) -> Callable[..., None]:
    """Saving that a full disk or a folder without permission does not stop: it only costs the next run its time."""

    def saved(*args: Any) -> None:
        with suppress(OSError):
            save(*args)

    return saved


def _readable(load: Callable[[], dict[Any, Any]]) -> Callable[[], dict[Any, Any]]:
    """What a cache holds; nothing where it is damaged, or names modules that are no longer there."""

    def loaded() -> dict[Any, Any]:
        try:
            found = load()
        except Exception:  # unpickling raises whatever it meets
            return {}
        return found if isinstance(found, dict) else {}

    return loaded
