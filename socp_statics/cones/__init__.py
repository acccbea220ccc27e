"""Cones of contact forces in the contact frame: (f_x, f_y, f_n) in R^3, with the torsional moment m_z in R^4.

A *cone* is exact; a *pyramid* or a linearised cone is polyhedral and says on which side of the exact one it lies.
"""

from socp_statics.cones.choice import ConeChoice as ConeChoice
from socp_statics.cones.convex_cone import ConvexCone as ConvexCone
from socp_statics.cones.elliptic_cone import EllipticCone as EllipticCone
from socp_statics.cones.friction_cone import FrictionCone as FrictionCone
from socp_statics.cones.friction_pyramid import FrictionPyramid as FrictionPyramid
from socp_statics.cones.polyhedral_cone import PolyhedralCone as PolyhedralCone
from socp_statics.cones.revolved_cone import RevolvedCone as RevolvedCone
from socp_statics.cones.soft_finger import SoftFingerCone as SoftFingerCone
