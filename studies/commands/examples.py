"""Lines that ``--help`` shows below the options: every option of every command in one of them, read by its parser.

What an option means does not enter here: that stands where it is added.
"""

from __future__ import annotations

EXAMPLES = {
    "list": ("scenes", "--use my_parts.py"),
    "show": ("tyre", "semismooth", "my-measure --use my_parts.py"),
    "solve": (
        "tyre --set delta_mm=10 --out out",
        "panel.inp --mesh 8x8 --plot --out out",
        "tyre --measure linear --contact qp --newton plain --model full --steps 4 --set backend=clarabel --out out",
        "hemisphere --error 1% --of outward_mm --budget 20s --out out",
        "hemisphere --mesh 100x100 --time-limit 60s --memory-limit 2000 --start cold --no-error --out out",
        "tyre --set mu=0.5 --set drag_mm=1,2 --no-step-error --use my_algorithm.py --out out",
        "tyre --gradient force_N:p0_MPa,gamma_deg --check-gradient --out out",
        "tyre --mesh 8x8 --set delta_mm=10 --branch --freeze step.npz --out out",
    ),
    "choose": (
        "tyre --error 1% --of force_N --budget 60s --set delta_mm=20 --out out",
        "panel.inp --contact trial-and-error --newton plain --mesh 2x2 --model full --steps 2 --out out",
        "hemisphere --use my_measure.py --out out",
    ),
    "sweep": (
        "tyre --over gamma_deg=46:58:8 --over p0_MPa=0.12:0.18:8 --set delta_mm=20 --out out",
        "pagano --over S=4:100:5 --mesh 16x16 --error 2% --of w_bar --measure linear --out out",
        "panel --over delta_mm=0.1:0.5:5 --contact lcp --newton plain --model full --steps 2 --out out",
        "panel --over delta_mm=0.1:0.5:5 --contact mine --use my_algorithm.py --out out",
    ),
    "resolve": ("step.npz --contact trial-and-error --epsilon 1e4 --oracle", "step.npz --contact mine --use mine.py"),
    "export": (
        "hemisphere --measure linear --mesh 20x20 --set load_fraction=1 --format inp --out hemisphere.inp",
        "pagano --through 2 --model full --format json --out pagano.json",
        "ring --integration reduced --stiffness 1e4 --format inp --out ring.inp",
        "mine --format vtu --use my_scene.py --out mine.vtu",
    ),
    "leaderboard": ("results --out board", "results --out board --use my_solver.py"),
    "problems": ("list", "--use my_scene.py make --out problems"),
    "problems list": ("--family tyre",),
    "problems make": ("--out problems --family ring", "--choose"),
    "problems check": ("problems --keep manifest.csv",),
    "problems export": ("problems/NAME.npz --format mps --out name.mps",),
    "problems import": ("lcp.dat --out lcp.npz",),
    "problems judge": ("problems/NAME.npz answer.json --tolerance 1e-6",),
    "judge-field": (
        "scordelis-lo roof.dat --measure linear --mesh 16x16 --ours 32x32 --tolerance 1%",
        "pagano field.csv --through 2 --model full --set S=4 --use my_parts.py",
    ),
    "run": (
        "quick --store store --engine local:2 --fields",
        "mine.toml --trust --resume --time-limit 60 --memory-limit 2048 --use my_measure.py",
        "fuzz --cases 100",
        "fuzz --seeds 50000:53000 --kind friction",
    ),
    "merge": ("theirs --store ours --again 5", "theirs --use my_measure.py"),
    "table": ("quick --store store --where outcome=wrong --csv cells.csv", "mine --use my_measure.py"),
    "time": (
        "quick --store store --only 1x64 --longest 5 --blocks 2 --rounds 4",
        "mine.toml --trust --use my_measure.py",
    ),
    "analyse": ("quick --store store", "mine --use my_measure.py"),
    "report": ("--store store --campaign quick --out pages", "--store store --check --use my_measure.py"),
    "advise": (
        "hemisphere --error 1% --quantity outward_mm --cost operations",
        "tyre --error 2% --store store --campaign standard --set delta_mm=20",
        "mine --error 1% --use my_scene.py",
    ),
    "check": (
        "--store store --campaign quick --baseline quick.csv",
        "--engine local:2 --use my_measure.py",
        "--update --owner 'A. Name' --reason 'new element' --date 2026-01-31",
        "--time before after",
    ),
    "compare": ("before after --campaign quick --out change.html", "before after --use my_measure.py"),
    "card": (
        "my_algorithm.py --check --out card.md",
        "--of semismooth",
        "--template my-entry",
        "my_algorithm.py --use my_scene.py",
    ),
    "extremes": ("", "thin-tyre --at 1e-3,0.5 --use my_measure.py"),
    "fuzz": ("--seed 17 --kind friction --smaller", "--seed 17 --use my_measure.py"),
    "bench": ("--rounds 5 --largest --table bench.csv", "--use my_measure.py"),
    "bench newton": ("--mesh 28x26 --repeats 5",),
    "bench scaling": ("--mesh 16x16,32x32 --machine floors --table scaling.csv",),
    "bench overhead": ("--repeats 5",),
    "bench peers": ("--only hemisphere --rounds 5 --table peers.csv",),
    "bench programs": ("--only hemisphere --store store",),
    "bench solvers": (
        "--problems problems --out store --rounds 3 --limit 20 --tolerance 1e-6,1e-8 --only OSQP --use my_solver.py",
        "--problems problems --out store --ablation",
        "--problems problems --held-out secret.txt --out store --results results",
        "--out store --against another",
    ),
}


def examples(program: str) -> str:
    """What ``--help`` of a command ends with."""
    command = program.partition(" ")[2]
    lines = [f"  {program} {words}".rstrip() for words in EXAMPLES.get(command, ())]
    return "\n".join(["examples:", *lines]) if lines else ""
