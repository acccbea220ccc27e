"""Wrench distribution in closed form: which contact components balance a wrench, by generalised inverses and their null spaces."""

from socp_statics.distribution.generalized_inverses import inverse_of_shares as inverse_of_shares
from socp_statics.distribution.generalized_inverses import pseudoinverse as pseudoinverse
from socp_statics.distribution.generalized_inverses import weighted_inverse as weighted_inverse
