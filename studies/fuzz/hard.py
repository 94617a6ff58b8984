"""Requests that were hard once: near-misses and findings of earlier campaigns, as commands.

:func:`studies.fuzz.near.grown` takes them from the table of a campaign; nothing but commands may enter here.
"""

COMMANDS = (
    "cantilever --mesh 128x1 --set load_fraction=1",
    "panel --mesh 4x4 --set shape=sphere --set delta_mm=0.2 --set mu=0.5 --set drag_mm=0.5,0",
    "panel --mesh 2x2 --set mu=1.49 --set drag_mm=0.0002113 --set turn_deg=0.06866",
    "tyre-solid --mesh 6x6 --set mu=2.05e-09 --set delta_mm=0.835 --set nu_LT=0.1452",
    "manufactured-contact --mesh 4x4 --set mu=0.0802",
    "tyre --mesh 6x8 --steps 3 --contact lcp --set mu=0.769 --set delta_mm=5.197,20.38,22.56 --set "
    "drag_mm=-0.006122,0.007235 --set drag_deg=120 --set pressure_area=mid --set plies=4 --set nu_LT=1.247 "
    "--set R0_mm=180.4",
    "tyre --mesh 6x8 --steps 4 --contact semismooth --set mu=inf --set delta_mm=0.815 --set "
    "drag_mm=-1.546,-1.596 --set p0_MPa=1.701 --set ply_thickness_mm=0.005103",
    "tyre --mesh 6x8 --newton mixed --steps 1 --contact regularised --set mu=inf --set delta_mm=14.7 --set "
    "drag_mm=1.943 --set drag_deg=-131 --set G_TT_MPa=4.957 --set R0_mm=165.3",
    "tyre --mesh 6x6 --contact trial-and-error --set mu=1.31 --set delta_mm=0.644 --set drag_mm=40.47 --set "
    "p0_MPa=2.394 --set E_T_MPa=6.755",
    "tyre --mesh 6x6 --measure moderate-rotation --contact lcp --set mu=1.26 --set delta_mm=0.875 --set "
    "drag_mm=-0.0008775,-0.0002078 --set E_MPa=1e-09 --set nu=-0.7745",
    "panel --mesh 4x3 --contact augmented-lagrangian --set mu=inf --set turn_deg=5.909,0 --set aspect=3.082 "
    "--set solver=splu --set tolerance=9.948e-10",
    "plate-contact --mesh 32x1 --contact qp --set mu=0.0599",
    "ring --mesh 1x3 --measure elongation --contact regularised --set mu=inf",
    "strip-contact --mesh 16x1 --measure moderate-rotation --contact lcp --set mu=0 --set load_fraction=16.49 "
    "--set interpolation=isoparametric --set thickness_strain=nodal --set tolerance=3.381e-09 --set "
    "method=lemke --set system=full",
    "tyre --mesh 6x6 --model sector --steps 4 --contact augmented-lagrangian --set mu=0 --set delta_mm=4.27",
    "panel --mesh 2x2 --measure thin-green-lagrange --contact trial-and-error --set mu=0.765 --set "
    "turn_deg=28.68,40.41,57.95,92.68 --set aspect=0.6186 --set load=dead --set epsilon=inf --set "
    "element=paper --set thickness_strain=balanced --set tolerance=0.1",
    "panel --mesh 3x2 --newton mixed --contact trial-and-error --set mu=0.31 --set "
    "drag_mm=0.0001307,0.0002575,0.0003843 --set turn_deg=-0.1497,0 --set E_ratio=6.751 --set gamma_deg=90 "
    "--set interpolation=isoparametric --set membrane=compatible",
    "tyre --mesh 6x6 --newton mixed --contact regularised --set mu=inf --set delta_mm=3.46 --set "
    "drag_mm=53.03,99.79,146.5 --set drag_deg=41 --set turn_deg=-3.504,5.607 --set clamp_deg=10 --set "
    "membrane=compatible",
    "panel --mesh 2x3 --contact regularised --set mu=1.99 --set drag_mm=0.008274,0.0003154 --set "
    "turn_deg=-0.03698,0.05459 --set inflation=16.8 --set stress_unit=0.4702 --set interpolation=isoparametric "
    "--set membrane=relaxed",
    "plate-contact --mesh 4x1 --steps 3 --contact semismooth --set mu=0.0319 --set membrane=relaxed",
    "strip-contact --mesh 4x1 --measure exact --set mu=1.3 --set epsilon=375.2",
    "ring --mesh 1x2 --measure novozhilov --contact semismooth --set mu=0.0544 --set delta_mm=12.84,19.88",
    "tyre --mesh 6x8 --measure novozhilov --newton mixed --steps 4 --contact lcp --set mu=0 --set delta_mm=5.91",
    "tyre --mesh 6x8 --measure elongation --steps 1 --contact qp --set mu=1.31 --set delta_mm=17.7 --set "
    "drag_mm=0.04693,-0.08368",
    "panel --mesh 3x3 --contact qp --set mu=1.31 --set drag_mm=-0.0001316,-0.0003931,-0.0006546 --set "
    "turn_deg=-0.4783,-0.1984,-0.1647 --set irregular=0.3566 --set stress_unit=0.2513",
    "panel --mesh 4x2 --contact trial-and-error --set mu=0.0223 --set turn_deg=0.009964,0.01699,0.04235,0.02455",
    "panel --mesh 2x16 --newton plain --steps 4 --set mu=inf --set drag_mm=0.2086,-0.3467 --set "
    "turn_deg=4.604,3.874 --set gamma_deg=35.85 --set ball_mm=8446 --set stress_unit=1e-12 --set "
    "epsilon=6.052e+04 --set membrane=relaxed --set settle=0.03418",
    "ring --mesh 1x32 --measure thin-green-lagrange --newton mixed --contact augmented-lagrangian --set "
    "mu=0.278 --set thickness_strain=nodal",
    "strip-contact --mesh 2x1 --newton mixed --steps 2 --contact augmented-lagrangian --set mu=0.201 --set "
    "lines=rim --set epsilon=inf --set element=paper --set thickness_strain=balanced --set solver=auto --set "
    "c=8794",
    "plate-contact --mesh 2x1 --measure sanders --contact trial-and-error --set mu=0.589",
    "panel --mesh 2x16 --contact lcp --set mu=0.0245 --set drag_mm=0.09128,0.2429,0.3945 --set drag_deg=-95 "
    "--set turn_deg=-0.008017,-0.01234,-0.01666",
    "ring --mesh 1x32 --measure von-karman --steps 4 --set mu=0.0397 --set tolerance=2.562e-10",
    "strip-contact --mesh 2x1 --measure linear --contact lcp --set mu=1.38 --set interpolation=curvilinear",
    "plate-contact --mesh 2x3 --measure thin-green-lagrange --steps 4 --contact lcp --set mu=0",
    "panel --mesh 4x4 --set shape=sphere --set delta_mm=0.2 --set mu=0.5 --set drag_mm=0.5,0 --set length_unit=0.5",
    "tyre --mesh 6x8 --set delta_mm=1 --set mu=0.2 --set drag_mm=4,0 --set E_MPa=20 --set nu=0.45",
    "panel --mesh 2x4 --contact qp --set mu=0.26 --set drag_mm=4.933,-4.052 --set turn_deg=0.04452",
    "panel --mesh 2x4 --contact qp --set mu=0.503 --set drag_mm=-0.00605,0.01197 --set aspect=1e+06 --set "
    "delta_mm=0.01045",
    "sze-moment --mesh 128x1",
    "plate-contact --mesh 128x1",
    "ring --mesh 1x64 --set delta_mm=37",
)
