"""Verdict and margin of a stance."""

from socp_statics.stability.equilibrium import EquilibriumAnswer as EquilibriumAnswer
from socp_statics.stability.equilibrium import check_equilibrium as check_equilibrium
from socp_statics.stability.many import EquilibriumAnswers as EquilibriumAnswers
from socp_statics.stability.many import check_equilibrium_many as check_equilibrium_many
