"""The general method called from other entries by its address: its code, the largest of the kernel, is compiled only once."""

from __future__ import annotations

from typing import Any

import numba
from llvmlite import ir
from numba import types
from numba.core.typing import signature
from numba.extending import intrinsic

from socp_statics.engines.kernel.conic import solve_plan

_STATUS_AND_STEPS = types.UniTuple(types.int64, 2)


def _call(typing: Any, address: Any, W: Any, F: Any, q: Any, b: Any, h: Any, limit: Any, x: Any, y: Any, z: Any, s: Any) -> Any:
    """`conic.solve` at ``conic.solve.address()``, an integer that is an argument of the calling entry; otherwise as `conic.solve_plan`."""
    given = (W, F, q, b, h, limit, x, y, z, s)

    def generate(context: Any, builder: Any, call: Any, values: Any) -> Any:
        kinds = [context.get_value_type(kind) for kind in given]
        callee = ir.FunctionType(context.get_value_type(_STATUS_AND_STEPS), kinds)
        return builder.call(builder.inttoptr(values[0], callee.as_pointer()), values[1:])

    return signature(_STATUS_AND_STEPS, address, *given), generate


def _interpreted(address: int, *given: Any) -> Any:
    """The same where nothing is compiled (NUMBA_DISABLE_JIT) and nothing has an address."""
    return solve_plan(*given)


solve_at = _interpreted if numba.config.DISABLE_JIT else intrinsic(_call)
