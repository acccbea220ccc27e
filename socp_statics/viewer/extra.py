"""The extra that the viewer needs."""

from __future__ import annotations

from importlib import import_module

from socp_statics.exceptions import InputError

NEEDED = ("viser", "trimesh")


def require_viewer() -> None:
    """Refuse to go on without the libraries of the viewer.

    Raises:
        InputError: One is missing; the sentence says how to install it.
    """
    for name in NEEDED:
        try:
            import_module(name)
        except ImportError as error:
            message = f"view: {name} cannot be imported, install the extra with: pip install 'socp-statics[viewer]'"
            raise InputError(message, name=name, field="view") from error
