"""Face and span forms of polyhedral cones by double description, checked before they are believed.

Double description in floating point is quick and fragile: on degenerate cones it loses or invents faces without a word. So it is
only given what it can digest - a pointed cone of full dimension, with its lines and equalities taken out as subspaces first,
in coordinates where its rays look the same in all directions - and what comes back is tested: every ray on the right side of every
face, every face touched by as many independent rays as a face has, every ray by as many faces, and no face missing from the hull
of a cross-section, which Qhull finds by another method. Data are never perturbed; what fails is an error.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.fft import dct
from scipy.spatial import ConvexHull, KDTree, QhullError

from socp_statics.exceptions import EngineError, InputError
from socp_statics.spatial import Array
from socp_statics.wrench_cones.combination import distance_of_span
from socp_statics.wrench_cones.forms import FaceForm, SpanForm, checked_length, units, vectors

MOST_RAYS = 192
ATTEMPTS = 6
ZERO, DOUBTFUL = 1e-9, 1e-6
TOUCHES = 1e-8
SAME = 1e-6
ADVICE = "contains, distance and support do without it"


def face_form(rays: ArrayLike, lines: ArrayLike | None = None, *, length: float = 1.0) -> FaceForm:
    """The faces of a cone that is known by its rays.

    Args:
        rays: Shape (r, d); redundant ones are allowed.
        lines: Rays open to both sides, shape (l, d).
        length: Length that moments are divided by to measure wrenches, d = 6 [m].

    Returns:
        Faces without redundant ones, orthogonal to the equalities, of such a length that ``U F`` is the distance from the face
        in the norm ``|(f, m / length)|``; equalities orthonormal in the same sense.

    Raises:
        InputError: Wrong shapes, more than 192 rays, or the extra ``[cdd]`` is missing.
        EngineError: The cone is so nearly flat or degenerate that the two forms contradict each other.
    """
    V, N = _pair(rays, lines, "rays", "lines")
    unit = units(V.shape[1], checked_length(length))
    faces, equalities = _faces(V / unit, N / unit)
    return FaceForm(faces / unit, equalities / unit, float(length))


def span_form(faces: ArrayLike, equalities: ArrayLike | None = None, *, length: float = 1.0) -> SpanForm:
    """The rays of a cone that is known by its faces: the faces of the cone that the faces span.

    Args:
        faces: U of ``U F <= 0``, shape (k, d); redundant ones are allowed.
        equalities: E of ``E F = 0``, shape (e, d).
        length: As in `face_form`.

    Returns:
        Extreme rays orthogonal to the lines, of unit length in the norm ``|(f, m / length)|``; lines orthonormal in it.

    Raises:
        InputError: Wrong shapes, more than 192 faces, or the extra ``[cdd]`` is missing.
        EngineError: The cone is so nearly flat or degenerate that the two forms contradict each other.
    """
    U, E = _pair(faces, equalities, "faces", "equalities")
    unit = units(U.shape[1], checked_length(length))
    rays, lines = _faces(U * unit, E * unit)
    return SpanForm(rays * unit, lines * unit, float(length))


def extreme_rays(rays: Array, form: FaceForm) -> SpanForm:
    """The span form of a cone whose faces are known: those of its rays that as many faces meet in as in an edge.

    Args:
        rays: Rays that span the cone, its lines aside, shape (r, d).
        form: Its faces.

    Returns:
        Extreme rays orthogonal to the lines, of unit length in the norm ``|(f, m / length)|``; lines orthonormal in it.
    """
    unit = units(rays.shape[1], form.length)
    U, E = form.faces * unit, form.equalities * unit
    across, lines = _range(np.vstack([U, E]))
    V = _unit_rows(_unit_rows(rays / unit) @ across @ across.T)
    edges: list[Array] = []
    for v in V:
        meeting = np.vstack([U[np.abs(U @ v) <= TOUCHES], E])
        if np.linalg.matrix_rank(meeting, tol=SAME) >= across.shape[1] - 1 and all(np.abs(v - e).max() > SAME for e in edges):
            edges.append(v)
    return SpanForm(np.array(edges).reshape(-1, len(unit)) * unit, lines.T * unit, form.length)


def _pair(first: ArrayLike, second: ArrayLike | None, word: str, other: str) -> tuple[Array, Array]:
    A = np.array(first, dtype=float) if np.size(first) == 0 else vectors(first, np.shape(first)[-1], word)
    if A.ndim != 2 or not A.shape[1]:
        raise InputError(f"{word} must be a matrix with one of them a row, got shape {A.shape}", field=word)
    B = np.zeros((0, A.shape[1])) if second is None or np.size(second) == 0 else np.atleast_2d(vectors(second, A.shape[1], other))
    return A, B


def _faces(rays: Array, lines: Array) -> tuple[Array, Array]:
    """Unit outward normals of the facets of ``span(rays) + lines``, and an orthonormal basis of what is orthogonal to all of it."""
    if len(rays) > MOST_RAYS:
        sentence = f"double description is the wrong tool for {len(rays)} rays, at most {MOST_RAYS} are expected; {ADVICE}"
        raise InputError(sentence, field="sides")
    inside, outside = _range(np.vstack([_unit_rows(rays), _unit_rows(lines)]))
    V, named = _unit_rows(rays) @ inside, _unit_rows(lines) @ inside
    across = _range(named)[1]
    while True:
        seen = V @ across
        sizes = np.linalg.norm(seen, axis=1)
        pointed = seen[sizes > ZERO] / sizes[sizes > ZERO, None]
        backward = [k for k in np.flatnonzero(sizes > ZERO) if distance_of_span(pointed, -seen[k] / sizes[k]) <= ZERO]
        if not backward:
            break
        # Rays that the others turn back span lines that nobody named: internal forces.
        named = np.vstack([named, V[backward]])
        across = _range(named)[1]
    faces = _facets(pointed) @ across.T @ inside.T
    # The order of the faces does not depend on that of the rays.
    return faces[np.lexsort(np.round(faces, 7).T[::-1])], outside.T


def _unit_rows(rows: Array) -> Array:
    """Rows of unit length, without those that are zero."""
    lengths = np.linalg.norm(rows, axis=1)
    kept = lengths > ZERO * lengths.max(initial=0.0)
    unit: Array = rows[kept] / lengths[kept, None]
    return unit


def _range(rows: Array) -> tuple[Array, Array]:
    """Orthonormal columns of what rows of unit length span, and of what is orthogonal to them."""
    _, s, Vt = np.linalg.svd(np.vstack([rows, np.zeros((1, rows.shape[1]))]))
    share = s / max(float(s[0]) if s.size else 0.0, 1.0)
    if ((share > ZERO) & (share < DOUBTFUL)).any():
        raise _inconsistent(f"the cone is flat but for a share of {share[share > ZERO].min():.0e}")
    rank = int((share > ZERO).sum())
    return Vt[:rank].T, Vt[rank:].T


def _facets(V: Array) -> Array:
    """Unit outward normals of the facets of a pointed cone of full dimension.

    Args:
        V: Unit rays, shape (n, d).
    """
    dimension = V.shape[1]
    if dimension == 0:
        return np.zeros((0, 0))
    if dimension == 1:
        return -np.sign(V[:1])
    round_, T = _rounded(V)
    turn = dct(np.eye(dimension), norm="ortho", axis=0)
    for k in range(ATTEMPTS):
        # Whether double description succeeds hangs on the axes; turning them is no change of the cone.
        Q = np.linalg.matrix_power(turn, k)
        try:
            U = _described(round_ @ Q) @ Q.T
            _check(U, round_)
        except EngineError as error:
            failure = error
        else:
            return _unit_rows(U @ T.T)
    raise failure


def _rounded(V: Array) -> tuple[Array, Array]:
    """Rays ``V T`` of unit length that are spread alike in all directions."""
    T = np.eye(V.shape[1])
    rows = V
    for _ in range(3):
        values, axes = np.linalg.eigh(rows.T @ rows / len(rows))
        T = T @ (axes / np.sqrt(values)) @ axes.T
        rows = _unit_rows(V @ T)
    return rows, T


def _described(V: Array) -> Array:
    """Facet normals by double description."""
    cdd = _cdd()
    generators = np.hstack([np.zeros((len(V), 1)), V])
    try:
        matrix = cdd.matrix_from_array(generators.tolist(), rep_type=cdd.RepType.GENERATOR)
        found = cdd.copy_inequalities(cdd.polyhedron_from_matrix(matrix))
    except RuntimeError as error:
        raise _inconsistent("cddlib gave up") from error
    if found.lin_set:
        raise _inconsistent("equalities were found where there are none")
    return _of_facets(_unit_rows(-np.array(found.array, dtype=float).reshape(-1, V.shape[1] + 1)[:, 1:]), V)


def _of_facets(U: Array, V: Array) -> Array:
    """The rows that as many independent rays touch as span a facet; the others are redundant."""
    dimension = V.shape[1]
    squares = (V[:, :, None] * V[:, None, :]).reshape(len(V), -1)
    touching = (np.abs(U @ V.T) <= TOUCHES).astype(float)
    # Rank by the eigenvalues of sums of squares: thousands of rows at once.
    spread = np.linalg.eigvalsh((touching @ squares).reshape(-1, dimension, dimension))
    return U[spread[:, 1] > SAME**2] if len(U) else U


def _check(U: Array, V: Array) -> None:
    """Whether faces and rays are two forms of one cone.

    Raises:
        EngineError: They are not.
    """
    dimension = V.shape[1]
    if not len(U) or (U @ V.T).max() > TOUCHES:
        raise _inconsistent("a ray lies outside a face")
    if KDTree(U).query_pairs(SAME):
        raise _inconsistent("two faces are the same but for rounding")
    if dimension < 3:
        return
    # The hull of a cross-section has to have these faces and no others.
    upward = -U.mean(axis=0)
    height = V @ upward
    if height.min() <= SAME:
        raise _inconsistent("the cone is all but a half-space")
    plane = np.linalg.svd(upward[None])[2][1:]
    try:
        hull = ConvexHull((V / height[:, None]) @ plane.T)
    except QhullError as error:
        raise _inconsistent("its cross-section is flat") from error
    # Qhull cuts facets into simplices, and the normals of slivers are rounding.
    normals = _of_facets(_unit_rows(hull.equations[:, :-1] @ plane + hull.equations[:, -1:] * upward), V)
    nearest = normals @ U.T
    if np.sqrt(np.maximum(2.0 - 2.0 * np.array([nearest.max(axis=1).min(), nearest.max(axis=0).min()]), 0.0)).max() > SAME:
        raise _inconsistent("the hull of a cross-section has other faces")


def _inconsistent(why: str) -> EngineError:
    return EngineError(f"double description is the wrong tool here, {why}; {ADVICE}", name="cdd")


def _cdd() -> Any:
    try:
        import cdd
    except ImportError as error:
        sentence = "double description needs the extra [cdd]: pip install 'socp-statics[cdd]'"
        raise InputError(sentence, name="cdd", field="cdd") from error
    return cdd
