"""From a stance to the arrays of its convex set, and back to forces; and the chapter's maps of a humanoid, with its symbols.

    C_cB, C_cC   contact_map            contact components to the wrench about the base or the centre of mass
    F_B, F_C     body_wrench            wrench of the reactions on the composite rigid body (3.55), (3.56); summed_wrench (3.57)
    F_net        net_wrench             sum without lever arms (3.58)
    G_B          gravity_wrench         reaction to gravity at the base (3.59)
    g_theta      gravity_torque         torque that holds the links (3.60)
    J_cB, J_cM   contact_jacobian, mixed_jacobian
    tau          stacked_torque (3.71), contact_torques (3.72), torque_components (3.73) in torque_components
    tau_B        static_torque          (3.74)
    tau_M        lumped_torque          (3.75)

Contacts push on the robot in all of them: F are reactions.
"""

from socp_statics.statics.assemble import assemble as assemble
from socp_statics.statics.contact_maps import body_wrench as body_wrench
from socp_statics.statics.contact_maps import contact_jacobian as contact_jacobian
from socp_statics.statics.contact_maps import contact_map as contact_map
from socp_statics.statics.contact_maps import contact_maps as contact_maps
from socp_statics.statics.contact_maps import gravity_wrench as gravity_wrench
from socp_statics.statics.contact_maps import lumped_torque as lumped_torque
from socp_statics.statics.contact_maps import mixed_jacobian as mixed_jacobian
from socp_statics.statics.contact_maps import net_wrench as net_wrench
from socp_statics.statics.contact_maps import summed_wrench as summed_wrench
from socp_statics.statics.joint_torques import gravity_torque as gravity_torque
from socp_statics.statics.joint_torques import static_torque as static_torque
from socp_statics.statics.point_forces import PointForces as PointForces
from socp_statics.statics.point_forces import point_forces as point_forces
from socp_statics.statics.statics_data import StaticsData as StaticsData
from socp_statics.statics.units import Units as Units
from socp_statics.statics.wrench_range import wrench_range as wrench_range
