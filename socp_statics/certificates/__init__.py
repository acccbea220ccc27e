"""Certificates: what makes an answer checkable without the solver."""

from socp_statics.certificates.certificate import ForcesCertificate as ForcesCertificate
from socp_statics.certificates.certificate import MotionCertificate as MotionCertificate
from socp_statics.certificates.certificate import motion_certificate as motion_certificate
from socp_statics.certificates.contact_motion import Motion as Motion
from socp_statics.certificates.contact_motion import motion_of as motion_of
from socp_statics.certificates.force_check import ForceResiduals as ForceResiduals
from socp_statics.certificates.force_check import force_residuals as force_residuals
