"""Pictures of stances, regions, robots and answers. They draw what was computed; nothing here solves."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from matplotlib.axes import Axes

from socp_statics.contacts import ContactSet, Stance
from socp_statics.exceptions import InputError
from socp_statics.figures.answer_figure import answer_figure as answer_figure
from socp_statics.figures.answer_figure import draw_answer as draw_answer
from socp_statics.figures.answer_figure import save_figure as save_figure
from socp_statics.figures.comparison_figure import comparison_figure as comparison_figure
from socp_statics.figures.comparison_figure import save_comparison as save_comparison
from socp_statics.figures.draw_following import draw_following as draw_following
from socp_statics.figures.draw_motion import draw_motion as draw_motion
from socp_statics.figures.draw_region import draw_base_of_support as draw_base_of_support
from socp_statics.figures.draw_region import draw_region as draw_region
from socp_statics.figures.draw_robot import draw_robot as draw_robot
from socp_statics.figures.draw_robot import robot_views as robot_views
from socp_statics.figures.draw_stance import draw_stance as draw_stance
from socp_statics.figures.draw_torques import draw_torques as draw_torques
from socp_statics.figures.draw_window import draw_window as draw_window
from socp_statics.following import FollowingRegion
from socp_statics.optimization.internal_force_window import InternalForceWindow
from socp_statics.postures import Posture
from socp_statics.regions import BaseOfSupport, SupportRegion

Drawable = SupportRegion | FollowingRegion | InternalForceWindow | Stance | ContactSet | BaseOfSupport | Posture | Mapping[str, Any]


def draw(thing: Drawable, ax: Axes | None = None) -> Axes:
    """Draw a region, a stance, contacts, a base of support or a record on the floor plan; a posture from its side; a window of forces.

    Args:
        thing: What to draw.
        ax: Axes to draw into, the view grows as needed; by default those of a new figure with a legend.

    Returns:
        The axes, equal and in metres; those of an internal-force window are in newtons.

    Raises:
        InputError: It is none of these.
    """
    if isinstance(thing, SupportRegion):
        return draw_region(thing, ax)
    if isinstance(thing, FollowingRegion):
        return draw_following(thing, ax)
    if isinstance(thing, InternalForceWindow):
        return draw_window(thing, ax)
    if isinstance(thing, Stance | ContactSet):
        return draw_stance(thing, ax)
    if isinstance(thing, BaseOfSupport):
        return draw_base_of_support(thing, ax)
    if isinstance(thing, Posture):
        return draw_robot(thing, ax)
    if isinstance(thing, Mapping):
        return draw_answer(thing, ax)
    expected = "a support region, a window of forces, a stance, contacts, a base of support, a posture or a record is expected"
    raise InputError(f"draw: {expected}, got {type(thing).__name__}", name="draw", field="thing")
