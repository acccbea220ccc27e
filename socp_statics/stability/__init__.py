"""Verdict and margin of a stance."""

from socp_statics.stability.equilibrium import EquilibriumAnswer as EquilibriumAnswer
from socp_statics.stability.equilibrium import check_equilibrium as check_equilibrium
