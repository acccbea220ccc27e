"""Arrays without an owner: functions that take them count no references, which costs two atomic instructions for every argument of a call.

Whoever lends an array, ``call(borrowed(work))``, holds on to it until the call is over: as a rule because the call stands in a loop
whose next turn lends it again.
"""

from __future__ import annotations

from typing import Any

import numba
from numba.core.cgutils import get_null_value
from numba.extending import intrinsic


def _view(typing: Any, array: Any) -> Any:
    """The same array without its owner."""

    def generate(context: Any, builder: Any, call: Any, values: Any) -> Any:
        view = context.make_array(array)(context, builder, values[0])
        view.meminfo, view.parent = get_null_value(view.meminfo.type), get_null_value(view.parent.type)
        return view._getvalue()

    return array(array), generate


def _itself(array: Any) -> Any:
    """The array: where nothing is compiled (NUMBA_DISABLE_JIT) there is nothing to count."""
    return array


borrowed = _itself if numba.config.DISABLE_JIT else intrinsic(_view)
