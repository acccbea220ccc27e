"""Fig. 3.10 in numbers: how J_cB, J_B and C_cB split joint, end-link and base space at six postures, and the types of Table 3.1."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from socp_statics.figures.draw_robot import Pushes, add_robot
from socp_statics.figures.outlines import VIEWS
from socp_statics.figures.panels import fill_panel, panels, title_panels
from socp_statics.figures.style import GREEN, ORANGE, SKY
from socp_statics.postures import Posture
from socp_statics.report_figures import Need, stance_of
from socp_statics.statics.posture_types import PostureTypes, posture_types

NEEDS = {
    "HOAP-2, standing": Need("hoap2/double_stance"),
    "half squat": Need("hoap2/half_squat"),
    "single stance": Need("hoap2/single_stance"),
    "hands on wall": Need("hoap2/hands_on_the_wall"),
    "ANYmal C": Need("quadrupeds/anymal_c"),
    "TALOS, stairs": Need("talos/stairs"),
}
ROWS = (
    ("J_cB", SKY),
    ("J_B", SKY),
    ("J_cB^T", ORANGE),
    ("C_cB", ORANGE),
    ("C_cB^T", GREEN),
)


def _posture(record: Mapping[str, Any]) -> Posture:
    posture = stance_of(record).posture
    assert posture is not None
    return posture


def _splits(posture: Posture, types: PostureTypes) -> list[tuple[int, int]]:
    """Rank and nullity of the transform of each row."""
    joints, c = len(posture.robot.joints), types.constraints
    ranks = types.ranks
    return [
        (ranks["J_cB"], joints - ranks["J_cB"]), (ranks["J_B"], joints - ranks["J_B"]), (ranks["J_cB"], c - ranks["J_cB"]),
        (ranks["C_cB"], c - ranks["C_cB"]), (ranks["C_cB"], 6 - ranks["C_cB"]),
    ]  # fmt: skip


def draw(records: Mapping[str, Sequence[Any]]) -> Figure:
    """Robots above, the dimensions of the subspaces below."""
    figure, axes = panels(2, 6, high=1.2, foot=0.0, left=0.37, between=0.04)
    for column, name in enumerate(NEEDS):
        posture = _posture(records[name][0])
        robot, bars = axes[column], axes[6 + column]
        window = add_robot(robot, posture, VIEWS["side"], Pushes([], [], []), cones=False, named=False)
        fill_panel(robot, window)
        robot.set_xlabel("")
        robot.set_ylabel("")
        robot.set_xticks([])
        robot.locator_params(axis="y", nbins=3)
        robot.tick_params(labelsize=6.0)
        _add_bars(bars, _splits(posture, posture_types(posture)), first=column == 0)
    title_panels(axes[:6], list(NEEDS))
    axes[0].set_ylabel("z [m]", labelpad=1.0)
    axes[6].set_ylabel("")
    return figure


def _add_bars(ax: Axes, splits: list[tuple[int, int]], first: bool) -> None:
    """A bar for each transform: its range, filled, and its null space."""
    for row, ((_, colour), (rank, nullity)) in enumerate(zip(ROWS, splits, strict=True)):
        whole = rank + nullity
        ax.barh(row, rank / whole, color=colour, edgecolor="#333333", linewidth=0.5, height=0.72)
        ax.barh(row, nullity / whole, left=rank / whole, color="white", edgecolor="#333333", linewidth=0.5, height=0.72)
        if rank:
            ax.text(0.5 * rank / whole, row, str(rank), ha="center", va="center", fontsize=6.0)
        if nullity:
            ax.text((rank + 0.5 * nullity) / whole, row, str(nullity), ha="center", va="center", fontsize=6.0)
    ax.set_ylim(len(ROWS) - 0.45, -0.55)
    ax.set_xlim(0.0, 1.0)
    ax.set_xticks([])
    ax.set_yticks(range(len(ROWS)), [transform for transform, _ in ROWS] if first else [], fontsize=6.0)
    for side in ("top", "right", "bottom", "left"):
        ax.spines[side].set_visible(False)
    ax.tick_params(length=0.0, pad=1.0)


def caption(records: Mapping[str, Sequence[Any]]) -> str:
    """Which types hold."""
    parts = []
    for name in NEEDS:
        types = posture_types(_posture(records[name][0]))
        parts.append(f"{name}: {', '.join(types.names)}")
    return (
        "Dimensions of the fundamental subspaces of Fig. 3.10. Filled: row space of the transform named at the left; white: its null "
        "space. Blue bars split the joint space (J_cB, J_B), orange ones the end-link space (by the transpose of J_cB and by C_cB), green "
        f"ones the base space (by the transpose of C_cB). Types of Table 3.1. {'; '.join(parts)}."
    )
