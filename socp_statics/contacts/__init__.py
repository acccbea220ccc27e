"""Contacts, what they transmit, and the stance they form: (3.5)-(3.8), (3.15)-(3.23)."""

from socp_statics.contacts.contact import CONTACT_TYPES as CONTACT_TYPES
from socp_statics.contacts.contact import Contact as Contact
from socp_statics.contacts.contact import FrictionlessPointContact as FrictionlessPointContact
from socp_statics.contacts.contact import FrictionlessSurfaceContact as FrictionlessSurfaceContact
from socp_statics.contacts.contact import Handle as Handle
from socp_statics.contacts.contact import LineContact as LineContact
from socp_statics.contacts.contact import PointContact as PointContact
from socp_statics.contacts.contact import SoftFingerContact as SoftFingerContact
from socp_statics.contacts.contact import SurfaceContact as SurfaceContact
from socp_statics.contacts.contact import contact_from_statement as contact_from_statement
from socp_statics.contacts.contact_set import ContactSet as ContactSet
from socp_statics.contacts.stance import ExternalWrench as ExternalWrench
from socp_statics.contacts.stance import Stance as Stance
