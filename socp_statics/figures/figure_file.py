"""Files of figures: which endings there are, and the same bytes for the same figure."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from socp_statics.cases.writing import finished_or_absent
from socp_statics.exceptions import InputError
from socp_statics.figures.style import house_style

# a creation date would make every file different
METADATA: dict[str, dict[str, Any]] = {".pdf": {"CreationDate": None}, ".png": {}, ".svg": {"Date": None}}


def figure_path(path: str | os.PathLike[str]) -> Path:
    """The path of a figure.

    Args:
        path: A name that ends in .pdf, .png or .svg.

    Raises:
        InputError: The name ends otherwise.
    """
    target = Path(path)
    if target.suffix.lower() not in METADATA:
        raise InputError(f"figure {target}: a file that ends in {', '.join(METADATA)} is expected", name=str(target), field="path")
    return target


def write_figure(figure: Figure, path: Path, title: str) -> None:
    """Write a figure; the file is complete or not there.

    Args:
        figure: The figure.
        path: Of `figure_path`.
        title: What the file says of itself.

    Raises:
        OSError: The file cannot be written.
    """
    ending = path.suffix.lower()
    with house_style(), finished_or_absent(path) as draft:
        figure.savefig(draft, format=ending[1:], metadata=METADATA[ending] | {"Title": title})
