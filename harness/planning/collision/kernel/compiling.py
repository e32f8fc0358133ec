"""How the functions of this package are compiled, and how they find their arrays."""

# pyright: reportMissingTypeStubs=false

from __future__ import annotations

from typing import Any

import numba
from numba import types
from numba.extending import intrinsic
from numba.np.arrayobj import populate_array

_OPTIONS = {"error_model": "numpy", "_nrt": False}
_njit: Any = numba.njit
compiled: Any = _njit(no_cpython_wrapper=True, no_cfunc_wrapper=True, **_OPTIONS)
inlined: Any = _njit(inline="always", **_OPTIONS)

COLUMNS = 4
"""Numbers of the table for each array: its address, then its shape filled up with ones."""


def _view(dtype: Any, ndim: int) -> Any:
    """A function `view(table, index)`: the array of a table, which counts no references.

    Whoever calls the compiled code keeps the array alive.
    """
    array_type = types.Array(dtype, ndim, "C")

    def lower(context: Any, builder: Any, _: Any, arguments: Any) -> Any:
        table, index = arguments
        integer, item = table.type, context.get_data_type(dtype)
        start = builder.inttoptr(table, integer.as_pointer())
        first = builder.mul(index, integer(COLUMNS))
        address, *shape = (
            builder.load(builder.gep(start, [builder.add(first, integer(column))]))
            for column in range(1 + ndim)
        )
        size = integer(context.get_abi_sizeof(item))
        strides = [size]
        for length in reversed(shape[1:]):
            strides.insert(0, builder.mul(length, strides[0]))
        array = context.make_array(array_type)(context, builder)
        data = builder.inttoptr(address, item.as_pointer())
        populate_array(array, data, shape, strides, size, None)
        return array._getvalue()  # noqa: SLF001 - as numba's own intrinsics do

    @intrinsic
    def view(_: Any, __: Any, ___: Any) -> Any:
        return array_type(types.int64, types.int64), lower

    return view


floats_1d, floats_2d, floats_3d = (_view(types.float64, ndim) for ndim in (1, 2, 3))
integers_1d, integers_2d = (_view(types.int64, ndim) for ndim in (1, 2))
indices_1d, indices_2d = (_view(types.uint32, ndim) for ndim in (1, 2))


def assembly(entry: Any, arguments: int) -> tuple[str, str]:
    """The name and the optimised LLVM assembly of a function of 64-bit integers.

    It has numba's own calling convention: the address of the result and one that exceptions need
    come before the arguments, and it returns a status that is 0.
    """
    signature = types.int64(*[types.int64] * arguments)
    options = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, **_OPTIONS}
    function: Any = _njit(signature, **options)(entry)
    [result] = function.overloads.values()
    [text] = function.inspect_llvm().values()
    return result.fndesc.llvm_func_name, text
