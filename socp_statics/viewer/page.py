"""A scene as nodes of a viser server; the only place that knows how viser draws."""

from __future__ import annotations

import io
import socket
from collections.abc import Iterable, Mapping
from contextlib import redirect_stdout
from typing import Any

import numpy as np

from socp_statics.colours import BLACK
from socp_statics.spatial import Array
from socp_statics.viewer.body import body_name
from socp_statics.viewer.marks import Arrows, Frame, Lines, Mark, Name, Solid
from socp_statics.viewer.motion import Placement
from socp_statics.viewer.scene import LAYERS, Following, Scene

HOST = "127.0.0.1"
ROOT = "stance"
# from where the scene is looked at first: from ahead, the robot's left and above
VIEW, DISTANCE, FIELD_OF_VIEW = np.array([1.0, 0.75, 0.55]), 1.45, 0.75
NEAREST, FARTHEST = 0.01, 100.0
COM_SHARE = 0.018
AMBIENT, DIRECTIONAL = 1.7, 0.9
LIGHTS = {"above": (0.3, 0.2, 1.0), "ahead": (1.0, 0.3, 0.2), "aside": (-0.2, 1.0, 0.2), "behind": (-1.0, -1.0, 0.4)}


def start_server() -> Any:
    """A viser server on a free port of this machine; it prints nothing."""
    import viser

    with redirect_stdout(io.StringIO()):
        return viser.ViserServer(host=HOST, port=_free_port(), verbose=False)


def stop_server(server: Any) -> None:
    """End a server; it prints nothing."""
    with redirect_stdout(io.StringIO()):
        server.stop()


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind((HOST, 0))
        return int(probe.getsockname()[1])


def address(server: Any) -> str:
    """Where a browser finds the page."""
    return f"http://{HOST}:{server.get_port()}"


class Page:
    """The nodes of a scene. All of them hang below one frame at the scene's origin, so that a stance far away keeps its digits.

    Args:
        server: The viser server.
        scene: The scene.
    """

    def __init__(self, server: Any, scene: Scene):
        self.server, self.scene = server, scene
        self.nodes: dict[str, Any] = {}
        api = server.scene
        api.add_frame(ROOT, show_axes=False, position=scene.origin)
        self._layers = {layer: api.add_frame(f"{ROOT}/{layer}", show_axes=False) for layer in LAYERS}
        self._look()
        self._light()
        self._add_floor()
        for mark in scene.still:
            self._add(mark)
        self.nodes["com/ball"] = api.add_icosphere(f"{ROOT}/com/ball", COM_SHARE * scene.extent, rgb(BLACK), cast_shadow=False)

    def local(self, point_W: Array) -> Array:
        """A point of the world in coordinates of the nodes, shape (3,) [m]."""
        return np.asarray(point_W, dtype=float) - self.scene.origin

    def show(self, marks: Iterable[Arrows | Lines]) -> None:
        """Show arrows and lines in place of those with the same names.

        Args:
            marks: The arrows and lines; empty ones are hidden.
        """
        for mark in marks:
            node = self.nodes.get(mark.name)
            pieces = _pieces(mark, self._origin(mark.name))
            if node is None:
                self._add(mark)
                node = self.nodes[mark.name]
            elif len(pieces):
                node.points = pieces
            node.visible = bool(len(pieces))

    def show_layer(self, layer: str, visible: bool) -> None:
        """Show or hide one of `scene.LAYERS`.

        Args:
            layer: Its key.
            visible: Whether it is shown.
        """
        self._layers[layer].visible = visible

    def follow(self, moving: Following) -> None:
        """Show what follows the centre of mass, and all bodies where the stance has them.

        Args:
            moving: What follows.
        """
        self.show(moving.marks)
        self.place(moving.bodies, moving.com)

    def play(self, moving: Following, share: float) -> None:
        """Show the bodies and the centre of mass as the certified motion has them.

        Args:
            moving: What follows the centre of mass; nothing happens without a motion.
            share: Of the motion that is drawn, 0 to 1.
        """
        if moving.motion is not None:
            self.place(moving.motion.bodies(share), moving.motion.com(share))

    def place(self, bodies: Mapping[str, Placement], com: Array) -> None:
        """Move bodies and the ball of the centre of mass.

        Args:
            bodies: Name of the body to its placement.
            com: Where the centre of mass is, shape (3,) [m].
        """
        self.nodes["com/ball"].position = self.local(com)
        for name, at in bodies.items():
            node = self.nodes[body_name(name)]
            node.position = self.local(at.position)
            node.wxyz = quaternion(at.rotation)

    def _origin(self, name: str) -> Array:
        """What the coordinates of a mark are counted from: below a frame it has coordinates of its own."""
        return np.zeros(3) if name.rsplit("/", 1)[0] in self.nodes else self.scene.origin

    def _look(self) -> None:
        scene, camera = self.scene, self.server.initial_camera
        camera.look_at = scene.origin
        camera.position = scene.origin + DISTANCE * scene.extent * VIEW
        camera.fov = FIELD_OF_VIEW
        camera.near, camera.far = NEAREST * scene.extent, FARTHEST * scene.extent

    def _light(self) -> None:
        """Even light, in which colours are those of the figures; viser's own washes them out."""
        api = self.server.scene
        api.configure_environment_map(None)
        api.configure_default_lights(enabled=False)
        api.add_light_ambient("light/everywhere", intensity=AMBIENT)
        for name, way in LIGHTS.items():
            api.add_light_directional(f"light/{name}", intensity=DIRECTIONAL, position=way)

    def _add_floor(self) -> None:
        cell = 10.0 ** np.floor(np.log10(self.scene.extent / 2.0))
        middle = self.local(np.array([*self.scene.origin[:2], self.scene.floor]))
        wide = float(np.ceil(3.0 * self.scene.extent / cell) * cell)
        self.nodes["floor"] = self.server.scene.add_grid(
            f"{ROOT}/floor", width=wide, height=wide, cell_size=cell, section_size=5.0 * cell, position=middle, cell_color=(225, 225, 225),
            section_color=(200, 200, 200), fade_distance=FARTHEST * self.scene.extent, shadow_opacity=0.0,
        )  # fmt: skip

    def _add(self, mark: Mark) -> None:
        api, name = self.server.scene, f"{ROOT}/{mark.name}"
        origin = self._origin(mark.name)
        if isinstance(mark, Frame):
            node = api.add_frame(name, show_axes=False, position=mark.position - origin, wxyz=quaternion(mark.rotation))
        elif isinstance(mark, Solid):
            node = api.add_mesh_simple(
                name, mark.vertices - origin, mark.faces, color=rgb(mark.colour), opacity=None if mark.opacity == 1.0 else mark.opacity,
                flat_shading=mark.flat, side="double" if mark.opacity < 1.0 else "front", cast_shadow=False, receive_shadow=False,
            )  # fmt: skip
        elif isinstance(mark, Name):
            node = api.add_label(name, mark.text, position=mark.position - origin, anchor="bottom-center")
        elif isinstance(mark, Lines):
            node = api.add_line_segments(name, _drawable(_pieces(mark, origin)), rgb(mark.colour), thickness=mark.pixels,
                                         thickness_units="screen")  # fmt: skip
        else:
            thick = mark.thickness
            node = api.add_arrows(
                name, _drawable(_pieces(mark, origin)), linear_rgb(mark.colour), shaft_radius=thick, head_radius=2.2 * thick,
                head_length=5.0 * thick,
            )  # fmt: skip
        self.nodes[mark.name] = node


def quaternion(rotation: Array) -> Array:
    """A rotation matrix as viser wants it: (w, x, y, z)."""
    import pinocchio

    x, y, z, w = pinocchio.Quaternion(np.asarray(rotation, dtype=float)).coeffs()
    return np.array([w, x, y, z])


def rgb(colour: str) -> tuple[int, int, int]:
    """A colour ``"#RRGGBB"`` as three whole numbers."""
    red, green, blue = (int(colour[k : k + 2], 16) for k in (1, 3, 5))
    return red, green, blue


def linear_rgb(colour: str) -> tuple[int, int, int]:
    """A colour ``"#RRGGBB"`` as viser takes those of arrows: as shares of light, without the gamma of the screen."""
    shares = np.array(rgb(colour)) / 255.0
    light = np.where(shares <= 0.04045, shares / 12.92, ((shares + 0.055) / 1.055) ** 2.4)
    red, green, blue = (int(share) for share in np.rint(255.0 * light))
    return red, green, blue


def _pieces(mark: Arrows | Lines, origin: Array) -> Array:
    pieces = np.stack([mark.tails, mark.tails + mark.ways], axis=1) if isinstance(mark, Arrows) else mark.pieces
    return pieces - origin


def _drawable(pieces: Array) -> Array:
    """Pieces of which there is at least one: viser draws no empty set."""
    return pieces if len(pieces) else np.zeros((1, 2, 3))
