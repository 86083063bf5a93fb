"""How each command of the pages is run in a test: smaller, or not at all and why.

A page's commands are run in its order in one fresh folder, so that each finds what the
steps before it wrote. What is changed are options that a user has: sizes are turned
down, and a viewer is not opened.
"""

from kinds_of_steps import NotRun, Run, Step, below, make
from recording_steps import RECORDING_STEPS
from small import (
    CONCEALED,
    DIAGNOSED,
    FILM,
    IT_RUNS_THIS,
    SEARCH,
    SHORT,
    SLOW_TESTS,
    SMALL_STUDY,
    TESTS,
    TUNED,
)

PYTHON_AFTERWARDS = {"diagnosis.md": ("the knee is at 0.", "")}
"""Pages whose Python uses what their commands wrote: what each block must print."""

JOURNEYS: dict[str, dict[str, Step]] = RECORDING_STEPS | {
    "README.md": {
        "make walk": make("walk", "six minutes; optimize-gait below is the same"),
        "make test": TESTS,
        "make slow-tests": SLOW_TESTS,
        "make journeys": IT_RUNS_THIS,
        "groundwalk optimize-gait --population 150 --generations 15 --seed 1 "
        "--out runs/mine": Run(SEARCH, writes=below("runs/mine", TUNED), says="sim"),
        "groundwalk optimize-gait --resume runs/mine": Run(says="tuned"),
        "groundwalk evaluate start runs/mine/result.json --trials 30": Run(
            f"{SHORT} --out runs/evaluated",
            writes=below("runs/evaluated", ("report.html", "result.json", "walk.png")),
        ),
        "groundwalk evaluate start --worlds real --terrain lumps:amplitude_m=0.006": (
            Run(SHORT, says="real")
        ),
        "groundwalk optimize-gait --robot talos": Run(
            f"{SEARCH} --out runs/talos", writes=below("runs/talos", TUNED)
        ),
        "groundwalk terrain-stress start runs/mine/result.json": Run(
            "--families lumps --worlds sim --rungs 2 --trials 1 --out runs/stressed",
            writes=below("runs/stressed", ("report.html", "result.json", "*.png")),
        ),
        "groundwalk visualize runs/mine --open": Run(
            without=("--open",), writes=("runs/mine/walk.rrd", "runs/mine/search.rrd")
        ),
        "groundwalk render runs/mine --only tuned --out walk.gif": Run(
            FILM, writes=("walk.gif",)
        ),
        "groundwalk transfer toy": Run(
            "--out runs/toy", writes=("runs/toy/report.html", "runs/toy/result.json")
        ),
        "groundwalk transfer nao": Run(
            f"--methods 'no grounding' {SMALL_STUDY} --out runs/nao",
            writes=("runs/nao/report.html", "runs/nao/result.json", "runs/nao/*.png"),
        ),
        "groundwalk transfer nao-falls": NotRun(
            "a minute at its smallest, most of it spent on fitting networks",
            "groundwalk transfer cliff --noise 0.1 --episodes 100 --real-episodes 5",
            says="holds",
        ),
        "groundwalk record --robot nao --world real --motion chirp --hidden "
        "backlash@LKneePitch:gap=0.03 --out air.parquet": Run(
            "--duration 3", writes=("air.parquet",)
        ),
        "groundwalk check air.parquet --robot nao": Run(says="LKneePitch"),
        "groundwalk diagnose air.parquet --robot nao": Run(
            "--out runs/air", writes=below("runs/air", DIAGNOSED), says="verdict"
        ),
        "groundwalk predict runs/air new.parquet": NotRun(
            "this diagnosis of a short recording need not name anything; "
            "docs/diagnosis.md has one that does",
            "groundwalk predict --help",
            says="RECORDING...",
        ),
        "groundwalk convert arm.db3 --out arm.parquet": Run(
            writes=("arm.parquet",), says="torques from the efforts"
        ),
        "groundwalk concealed make set --cases 20 --seed 7": Run(
            "--cases 1 --seed 53", writes=CONCEALED
        ),
        "groundwalk export nao --format urdf --out nao.urdf": Run(writes=("nao.urdf",)),
        "groundwalk list robots": Run(says="nao"),
        "groundwalk list terrains": Run(says="lumps"),
        "groundwalk list gaits": Run(says="walk2014"),
        "groundwalk list effects": Run(says="backlash"),
        "groundwalk doctor": Run(says="mujoco"),
        "make results": make("results", "hours: it writes every page of docs/results"),
        "make results-pictures": make("results-pictures", "a minute of drawing"),
        "make env": NotRun("it sets up what this test runs in", "make -n env"),
        "python -m experiments.optimize_gait": NotRun(
            "the same as groundwalk optimize-gait above",
            "python -m experiments.optimize_gait --help",
            says="--population",
        ),
        "make bench": NotRun("minutes of timing", "make -n bench", says="benchmarks"),
    },
    "architecture.md": {
        "make lint": NotRun("a minute, beside the tests", "make -n lint", says="ruff"),
        "make test": TESTS,
        "make slow-tests": SLOW_TESTS,
        "make journeys": IT_RUNS_THIS,
        "python docs/draw_rooms.py docs/architecture.png": Run(
            "rooms.png", without=("docs/architecture.png",), writes=("rooms.png",)
        ),
    },
    "uneven_ground.md": {
        "groundwalk evaluate start docs/results/walk/result.json --worlds real "
        "--trials 10": Run(SHORT, says="real"),
        "groundwalk optimize-gait --terrain lumps:amplitude_m=0.008 --population 30 "
        "--generations 5 --out runs/lumps": Run(
            SEARCH, writes=below("runs/lumps", TUNED)
        ),
        "groundwalk evaluate runs/lumps/result.json --worlds real --trials 10": Run(
            SHORT, says="real"
        ),
        'groundwalk transfer nao --methods "SGAT, uneven sim" --real-walks 24 '
        "--more-real-walks 12 --sim-walks 48 --population 30 --generations 3 "
        "--trials 10 --out runs/grounded": Run(
            SMALL_STUDY, writes=("runs/grounded/report.html",)
        ),
        "groundwalk transfer nao --resume runs/grounded": Run(says="SGAT"),
        "make walk": make("walk", "six minutes; optimize-gait above is the same"),
    },
    "robots.md": {
        "groundwalk optimize-gait --robot g1 --out runs/g1": Run(
            SEARCH, writes=below("runs/g1", TUNED)
        ),
        "groundwalk optimize-gait --robot my_robot.urdf": Run(
            f"{SEARCH} --out runs/own", writes=below("runs/own", TUNED)
        ),
        "groundwalk evaluate runs/g1/result.json --robot g1": Run(SHORT),
        "groundwalk visualize runs/g1 --open": Run(
            without=("--open",), writes=("runs/g1/walk.rrd",)
        ),
        "groundwalk export g1 --format mjcf": Run(says="<mujoco"),
        "groundwalk humanoids": NotRun(
            "a quarter of an hour for all robots that have a name; one robot is below",
            "groundwalk humanoids --help",
            says="--real-trials",
        ),
        "groundwalk list robots": Run(says="g1"),
        "groundwalk humanoids --robots my_robot.urdf": Run(
            "--population 4 --generations 1 --ratings 1 --trials 1 --real-trials 1 "
            "--out runs/of-mine",
            writes=("runs/of-mine/report.html", "runs/of-mine/humanoids.png"),
        ),
    },
    "seeing.md": {
        "groundwalk evaluate start walk2014 --trials 3 --out runs/mine": Run(
            SHORT, writes=("runs/mine/report.html", "runs/mine/walk.rrd")
        ),
        "groundwalk visualize runs/mine --open": Run(
            without=("--open",), writes=("runs/mine/walk.rrd",)
        ),
        "groundwalk visualize runs/mine/recordings/sim_start.parquet "
        "runs/mine/recordings/real_start.parquet --out both.rrd": Run(
            writes=("both.rrd",)
        ),
        "groundwalk render runs/mine --only start --out walk.gif": Run(
            FILM, writes=("walk.gif",)
        ),
        "groundwalk render runs/mine/recordings/real_start.parquet --frames 6 "
        "--out strip.png": Run("--width 64 --height 64", writes=("strip.png",)),
    },
    "terrain_stress.md": {
        "groundwalk terrain-stress start docs/results/walk/result.json "
        "--out runs/stress": Run(
            "--families lumps --rungs 2 --trials 1",
            writes=below("runs/stress", ("report.html", "result.json", "*.png")),
        ),
        "groundwalk terrain-stress --resume runs/stress": Run(says="lumps"),
        "groundwalk terrain-stress start --families stairs friction --worlds real "
        "--trials 20": Run("--rungs 2 --trials 1", says="friction"),
        "make results-terrain-stress": make("results-terrain-stress", "an hour"),
        "groundwalk terrain-stress start": Run(
            "--families lumps --worlds sim --rungs 2 --trials 1"
        ),
    },
}
"""By page and by the command as it stands there."""
