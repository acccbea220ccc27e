"""Verdict and margin of a stance."""

from socp_statics.stability.equilibrium import EquilibriumAnswer as EquilibriumAnswer
from socp_statics.stability.equilibrium import check_equilibrium as check_equilibrium
from socp_statics.stability.many import EquilibriumAnswers as EquilibriumAnswers
from socp_statics.stability.many import check_equilibrium_many as check_equilibrium_many
from socp_statics.stability.margin_gradient import MarginGradient as MarginGradient
from socp_statics.stability.margin_gradient import margin_gradient as margin_gradient
from socp_statics.stability.simple_test import SimpleTest as SimpleTest
from socp_statics.stability.simple_test import simple_static_test as simple_static_test
from socp_statics.stability.strong import StrongAnswer as StrongAnswer
from socp_statics.stability.strong import check_strong_stability as check_strong_stability
