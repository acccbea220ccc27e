"""Optimal contact forces of a static posture, and better postures (3.7.2)."""

from socp_statics.optimization.capability import CapabilityAnswer as CapabilityAnswer
from socp_statics.optimization.capability import largest_load as largest_load
from socp_statics.optimization.capability import largest_payload as largest_payload
from socp_statics.optimization.capability import largest_push as largest_push
from socp_statics.optimization.contact_forces import optimise_contact_forces as optimise_contact_forces
from socp_statics.optimization.force_answer import ForceAnswer as ForceAnswer
from socp_statics.optimization.many import LargestForceAnswers as LargestForceAnswers
from socp_statics.optimization.many import minimise_largest_force_many as minimise_largest_force_many
from socp_statics.optimization.minimax_wrench import minimise_largest_wrench as minimise_largest_wrench
from socp_statics.optimization.posture_answer import PostureAnswer as PostureAnswer
from socp_statics.optimization.posture_optimization import optimise_posture as optimise_posture
from socp_statics.optimization.torque_use import minimise_torque_use as minimise_torque_use
from socp_statics.optimization.unit_load import unit_load as unit_load
