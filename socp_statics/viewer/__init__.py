"""The 3-D page of a problem: robot, contacts, cones, forces, regions, and a centre of mass to drag."""

from socp_statics.viewer.export import page_html as page_html
from socp_statics.viewer.export import save_page as save_page
from socp_statics.viewer.extra import require_viewer as require_viewer
from socp_statics.viewer.live import LiveView as LiveView
from socp_statics.viewer.question import Question as Question
from socp_statics.viewer.question import ask as ask
