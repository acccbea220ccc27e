"""Wrench distribution in closed form: which contact components balance a wrench, by generalised inverses and their null spaces.

One file for each idea of Sections 3.4 to 3.6, in their order:

    closed_loops           (3.24)-(3.27)   wrenches of a loop at its links, root and closure; limb torques
    contact_components     (3.28)-(3.30)   constraint and mobility, hard and soft parts
    limb_torques           (3.31)-(3.34)   torques part by part
    dual_null_space        (3.35)-(3.36)   null spaces of motion and force
    priorities             (3.37), (3.54)  which torque may not disturb which
    general_solution       (3.38)-(3.41)   particular solution and null space, rank, what cannot be balanced
    virtual_linkage        (3.42)-(3.45)   internal forces as members between contacts
    grasp_description      (3.46)-(3.50)   internal forces and moments to contact wrenches and back
    loop_torques           (3.51)-(3.52)   torques that compensate and torques that tighten
    friction_weights       (3.53)          weights by friction coefficients
    interdependent_loops   (3.61)-(3.66)   hands with given wrenches, feet with the rest
    independent_loops      (3.67)-(3.70)   feet on the floor, hands on an object

Section 5.10.4 is `lever_rule` and `barycentric_rule`, on the line of the load (`load_line`); `closed_form` has all methods side by side,
for batches too (`distributions`, `scaled_question`), `given_wrenches` those with references. Contact maps, the wrench of the composite
rigid body and gravity, (3.55)-(3.60), and whole torques, (3.71)-(3.75), are in `socp_statics.statics`.
"""

from socp_statics.distribution.closed_form import CLOSED_FORMS as CLOSED_FORMS
from socp_statics.distribution.distributions import Distributions as Distributions
from socp_statics.distribution.distributions import distribute_many as distribute_many
from socp_statics.distribution.general_solution import GeneralSolution as GeneralSolution
from socp_statics.distribution.general_solution import general_solution as general_solution
from socp_statics.distribution.generalized_inverses import inverse_of_shares as inverse_of_shares
from socp_statics.distribution.generalized_inverses import pseudoinverse as pseudoinverse
from socp_statics.distribution.generalized_inverses import weighted_inverse as weighted_inverse
from socp_statics.distribution.grasp_description import grasp_description as grasp_description
from socp_statics.distribution.independent_loops import independent_loops as independent_loops
from socp_statics.distribution.interdependent_loops import with_references as with_references
from socp_statics.distribution.virtual_linkage import linkage_matrix as linkage_matrix
from socp_statics.distribution.virtual_linkage import member_forces as member_forces
