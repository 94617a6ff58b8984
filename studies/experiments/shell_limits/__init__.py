"""How far the shell's own kinematics carry: the same body as a shell and as a solid, from thin walls to thick ones.

Geometry, law (St. Venant-Kirchhoff), supports and loads of a pair are the same; what differs is that the shell's
displacement is linear through the thickness and its law integrated. :mod:`.bodies` solves, the others hold the
cases, and :mod:`.ladder` lists them and separates the error of the mesh from that of the model. Nothing here knows a
page or a campaign; where a scene's limit lies is read off the table in studies.analysis.
"""
