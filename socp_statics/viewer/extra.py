"""The extra that the viewer needs."""

from __future__ import annotations

from importlib.util import find_spec

from socp_statics.exceptions import InputError

NEEDED = ("viser", "trimesh")


def require_viewer() -> None:
    """Refuse to go on without the libraries of the viewer.

    Raises:
        InputError: One is missing; the sentence says how to install it.
    """
    missing = [name for name in NEEDED if find_spec(name) is None]
    if missing:
        message = f"view: {' and '.join(missing)} cannot be imported, install the extra with: pip install 'socp-statics[viewer]'"
        raise InputError(message, name=missing[0], field="view")
