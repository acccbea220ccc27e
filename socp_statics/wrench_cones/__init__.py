"""Wrench cones: what a contact, and all contacts together, can exert on the robot: (3.13)-(3.14), (3.77)."""

from socp_statics.wrench_cones.body_wrench_cone import body_wrench_cone as body_wrench_cone
from socp_statics.wrench_cones.contact_wrench_cone import contact_wrench_cone as contact_wrench_cone
from socp_statics.wrench_cones.double_description import face_form as face_form
from socp_statics.wrench_cones.double_description import span_form as span_form
from socp_statics.wrench_cones.forms import FaceForm as FaceForm
from socp_statics.wrench_cones.forms import SpanForm as SpanForm
from socp_statics.wrench_cones.rectangle import rectangle_faces as rectangle_faces
from socp_statics.wrench_cones.slices import WrenchSlice as WrenchSlice
from socp_statics.wrench_cones.slices import acceleration_slice as acceleration_slice
from socp_statics.wrench_cones.slices import com_slice as com_slice
from socp_statics.wrench_cones.wrench_cone import Consistency as Consistency
from socp_statics.wrench_cones.wrench_cone import WrenchCone as WrenchCone
