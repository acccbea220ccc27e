"""A prepared program in two arrays, and where its parts are: compiled functions take few arrays quickly and many slowly.

The header of the integer array says how large the program is and where every part begins, in the integers or in the reals. All
indices are unsigned: a signed one is tested for being negative at every access, and mixed with an unsigned one it becomes a float.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Plan(NamedTuple):
    """A program without its right-hand sides, prepared by `plan.plan_rows`; one thread at a time may solve it.

    Attributes:
        whole: Header and structure.
        real: Numbers and workspace.
    """

    whole: NDArray[np.uint64]
    real: NDArray[np.float64]


ZERO, ONE, TWO, THREE, FOUR, FIVE = (np.uint64(i) for i in range(6))


def _indices(start: int, stop: int) -> tuple[np.uint64, ...]:
    return tuple(np.uint64(i) for i in range(start, stop))


# Sizes: unknowns, equality rows, cone rows, rows of the orthant; unknowns kept, equality rows kept, pivot rows, free unknowns,
# free unknowns whose columns are combinations, cones (each row of the orthant is one), runs of second-order cones of equal dimension and
# equal number of columns.
N, P, M, L, KEPT, EQUAL, PIVOTS, FREE, SHARED, CONES, RUNS = _indices(0, 11)

# Integers. Of each cone: first row, where its columns begin, where its values begin. Columns cone by cone. Runs: number of cones,
# dimension, number of columns. First column of each row of H, where each row begins. Where the products of a cone's columns are added
# to H. Original index of the kept and of the free unknowns. Index among the free unknowns of the one that a pivot row expresses. Original
# index of the equality rows: pivot rows, rows kept, repeated rows.
CONE, COLUMN, RUN, FIRST, START, PAIR, KEPT_AT, FREE_AT, PIVOT_AT, ROW_AT = _indices(11, 21)

# Reals. Free columns as combinations of others (SHARED, N). Combinations of original equality rows (P, P). Pivot rows in free
# (PIVOTS, FREE) and in kept unknowns (PIVOTS, KEPT). Kept rows in kept unknowns (EQUAL, KEPT). Scaled diagonal of P.
# Scalings of unknowns, equality rows, cone rows. Values of G cone by cone.
SHARE, MIX, U_AT, B_AT, A_AT, DIAGONAL, BY_COLUMN, BY_ROW, BY_CONE, VALUE = _indices(21, 31)

# Workspace. H and its factor, scaled values of G, L^-1 A', the same row by row, without and with
# D^-1; reduced matrix; vectors of length KEPT, EQUAL, M, CONES, N and P; scalars.
H_AT, SCALED, Y_AT, S_AT, VECTORS_K, VECTORS_E, VECTORS_M, ETA, VECTORS_N, VECTORS_P, SCALARS = _indices(31, 42)
HEADER = 42

# Vectors of length KEPT: cost, diagonal, unknowns, constant and varying direction, residual, right-hand side, workspace, reciprocal
# pivots, units of the residual, best unknowns.
COST, CURVE, X, X_FIXED, X_STEP, R_DUAL, U_SIDE, OFF_U, BY_PIVOT, UNIT_DUAL, BEST_X = _indices(0, 11)
# Of length EQUAL: right-hand side, multipliers, directions, residual, right-hand side, workspace, reciprocal pivots, units, best.
LOAD, Y, Y_FIXED, Y_STEP, R_EQUAL, V_SIDE, OFF_V, BY_ROW_PIVOT, UNIT_EQUAL, BEST_Y = _indices(0, 10)
# Of length M: right-hand side, slacks, multipliers, scaling points, lambda, directions, residual and scaled
# residual, steps, right-hand side, units, best.
LIMIT, S, Z, W, LAMBDA, Z_FIXED, Z_STEP, R_CONE, R_SCALED, DS, DZ, W_SIDE, UNIT_CONE, BEST_S, BEST_Z = _indices(0, 15)
COUNT_K, COUNT_E, COUNT_M, COUNT_N, COUNT_P = 11, 10, 15, 2, 2

# Scalars. The embedding's; units of unknowns and of cost, constant of the objective, degree of the cones, sizes of the data; objective,
# dual objective and tau of the best iterate; and what the current one would be as a certificate: b' y + h' z, q' x
# and what they leave over.
TAU, KAPPA, UNIT_X, UNIT_COST, CONSTANT, DEGREE, SIZE_B, SIZE_Q, PRIMAL, DUAL, BEST_TAU = _indices(0, 11)
LOAD_VALUE, COST_VALUE, UNBALANCED, UNMET = _indices(11, 15)
# Least pivots of H as a share of their diagonal, and how often a direction may be corrected.
FLOOR, CORRECTIONS = _indices(15, 17)
COUNT_SCALARS = 17
