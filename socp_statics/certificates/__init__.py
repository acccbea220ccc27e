"""Certificates: what makes an answer checkable without the solver."""

from socp_statics.certificates.certificate import ForcesCertificate as ForcesCertificate
from socp_statics.certificates.certificate import MotionCertificate as MotionCertificate
from socp_statics.certificates.certificate import motion_certificate as motion_certificate
from socp_statics.certificates.force_check import force_residuals as force_residuals
