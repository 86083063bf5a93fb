"""How each command of the pages is run in a test: smaller, or not at all and why.

A page's commands are run in its order in one fresh folder, so that each finds what the
steps before it wrote. What is changed are options that a user has: sizes are turned
down, and a viewer is not opened.
"""

from kinds_of_steps import NotRun, Run, Step, below, make

SHORT = "--trials 1 --course-m 0.3"
SEARCH = f"--population 4 --generations 1 --ratings 1 {SHORT}"
FILM = "--duration 0.3 --width 64 --height 64"
SMALL_STUDY = (
    "--trials 2 --course-m 0.3 --population 4 --generations 1 --ratings 1 "
    "--repeats 1 --real-walks 2 --more-real-walks 2 --sim-walks 2 "
    "--real-population 4 --real-generations 1"
)
TUNED = (
    "report.html", "result.json", "result.md", "config.json", "provenance.json",
    "history.json", "walk.rrd", "walk.png", "search.png", "recordings/*.parquet",
)  # fmt: skip
CONCEALED = ("set/cases/case_000/**/*.parquet", "set/sealed.sha256")
PREDICTED = (
    "report.html", "result.json", "result.md", "audit.json", "config.json",
    "provenance.json", "channel_1.png",
)  # fmt: skip
CORRECTED = (
    "corrected.xml", "corrected.json", "corrected_laws.py", "test_corrected_laws.py",
)  # fmt: skip
DIAGNOSED = ("report.html", "diagnosis.json", "audit.json", "overlay.rrd")


TESTS = NotRun("minutes, beside this test", "make -n test", says="--ignore")
IT_RUNS_THIS = NotRun("it runs this test", "make -n journeys", says="tests/journeys")

REAL = NotRun(
    "minutes to an hour, with recordings of real robots that are not in the repository",
    "groundwalk real-robots so101 --data nowhere",
    status=2,
    says="nowhere",
)
"""Without the recordings there is one clear line."""

PYTHON_AFTERWARDS = {"diagnosis.md": ("the knee is at 0.", "")}
"""Pages whose Python uses what their commands wrote: what each block must print."""

JOURNEYS: dict[str, dict[str, Step]] = {
    "README.md": {
        "make walk": make("walk", "six minutes; optimize-gait below is the same"),
        "make test": TESTS,
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
    "check.md": {
        "groundwalk record --robot so101 --motion ramps --duration 20 "
        "--out slow.parquet": Run("--duration 8", writes=("slow.parquet",)),
        "groundwalk check slow.parquet --out runs/slow": Run(
            writes=below(
                "runs/slow",
                ("report.html", "result.json", "result.md", "next/slow_ramps.csv"),
            ),
            says="The smallest sizes that would be told",
        ),
        "groundwalk record --plan --robot so101 --out motions": Run(
            writes=("motions/slow_ramps.csv", "motions/chirp.csv"), says="good for"
        ),
        "groundwalk record --robot so101 --play motions/slow_ramps.csv "
        "--out ramps.parquet": Run(writes=("ramps.parquet",), says="2401 ticks"),
        "groundwalk check slow.parquet ramps.parquet": Run(says="can be diagnosed"),
    },
    "your_robot.md": {
        "groundwalk convert logs --robot my_arm.urdf --servo mx-64@12V,P=32 "
        "--out recordings --yes": Run(
            writes=below("recordings", ("chirp.parquet", "ramps.parquet")),
            says="joints shoulder, elbow, wrist",
        ),
        "groundwalk check recordings --out runs/check": Run(
            writes=below("runs/check", ("report.html", "next/chirp.csv")),
            says="can be diagnosed",
        ),
        "groundwalk diagnose recordings --out runs/arm": Run(
            writes=below("runs/arm", (*DIAGNOSED, "corrected.xml", "corrected.json")),
            says="dry friction at the joint elbow: torque 0.2",
        ),
        "groundwalk convert tuesday.csv --robot my_arm.urdf --servo mx-64@12V,P=32 "
        "--out tuesday.parquet --yes": Run(writes=("tuesday.parquet",)),
        "groundwalk predict runs/arm tuesday.parquet --out runs/tuesday": Run(
            writes=("runs/tuesday/report.html",), says="judgement   holds"
        ),
        "groundwalk list servos": Run(says="mx-64"),
        "python -m mujoco.viewer --mjcf=runs/arm/corrected.xml": NotRun(
            "it opens a window", "python -m mujoco.viewer --help", says="--mjcf"
        ),
    },
    "concealed.md": {
        "groundwalk concealed make set": Run(
            "--cases 1 --seed 3",
            writes=CONCEALED,
        ),
        "groundwalk concealed run set": Run(writes=("set/answers/case_000.json",)),
        "groundwalk concealed run set --by sysid": Run(),
        "groundwalk concealed score set": Run(
            writes=("set/score.json", "set/score.md", "set/score.png")
        ),
        "make results-concealed": make("results-concealed", "two hours"),
        "groundwalk concealed make runs/identical --set 4 --cases 60": Run(
            "--cases 1", writes=("runs/identical/cases/case_000/recordings/*.parquet",)
        ),
        "groundwalk concealed make set --real data": NotRun(
            "recordings of real robots are needed",
            "groundwalk concealed make --help",
            says="--real",
        ),
    },
    "concealed_answers.md": {
        "groundwalk concealed run set": NotRun(
            "docs/concealed.md takes it, where a set is made first",
            "groundwalk concealed run --help",
            says="--by",
        ),
        "groundwalk concealed score set --answers data": NotRun(
            "another tool's answers are needed",
            "groundwalk concealed score --help",
            says="--answers",
        ),
        "groundwalk list effects": Run(says="backlash"),
    },
    "diagnosis.md": {
        "groundwalk record --robot so101 --motion multisine --hidden "
        "coulomb_friction@elbow_flex:torque=0.1 --out a.parquet": Run(
            "--duration 4", writes=("a.parquet", "a.nominal.urdf")
        ),
        "groundwalk record --robot so101 --motion ramps --seed 2 --hidden "
        "coulomb_friction@elbow_flex:torque=0.1 --out b.parquet": Run(
            "--duration 4", writes=("b.parquet",)
        ),
        "groundwalk diagnose a.parquet b.parquet --out runs/elbow": Run(
            writes=below("runs/elbow", (*DIAGNOSED, "corrected.xml", "corrected.json")),
            says="elbow_flex",
        ),
        "groundwalk record --robot nao --motion multisine --duration 20 --hidden "
        "speed_limit@LKneePitch:speed=2.5 --out knee.parquet": Run(
            "--duration 9", writes=("knee.parquet",)
        ),
        "groundwalk diagnose knee.parquet --robot nao --out runs/knee": Run(
            writes=below("runs/knee", (*DIAGNOSED, *CORRECTED)), says="LKneePitch"
        ),
        "python -m mujoco.viewer --mjcf=runs/knee/corrected.xml": NotRun(
            "it opens a window", "python -m mujoco.viewer --help", says="--mjcf"
        ),
        "python -m pytest runs/knee": Run(says="2 passed"),
        "groundwalk optimize-gait --sim runs/knee": Run(
            f"{SEARCH} --out runs/tuned", writes=("runs/tuned/report.html",)
        ),
        "groundwalk transfer nao --sim runs/knee --hidden "
        "speed_limit@LKneePitch:speed=2.5": Run(
            f"--methods 'diagnosed sim' {SMALL_STUDY} --out runs/nao",
            writes=("runs/nao/report.html",),
        ),
        "groundwalk record --robot so101 --motion steps --seed 3 --hidden "
        "coulomb_friction@elbow_flex:torque=0.1 --out c.parquet": Run(
            "--duration 4", writes=("c.parquet",)
        ),
        "groundwalk predict runs/elbow c.parquet": Run(
            "--out runs/predicted",
            writes=below("runs/predicted", PREDICTED),
            says="holds: the corrected sim's error is",
        ),
        "groundwalk list servos": Run(says="sts3215"),
        "groundwalk diagnose air.parquet": NotRun(
            "how commands look in general; those above are of this kind",
            "groundwalk diagnose --help",
            says="--reference",
        ),
        "groundwalk diagnose --resume runs/knee": Run(says="LKneePitch"),
        "make results-diagnosed-gait": make("results-diagnosed-gait", "an hour"),
        "groundwalk real-robots so101 --data data": REAL,
        "groundwalk real-robots emps --data data": REAL,
        "groundwalk real-robots go2 --data data": REAL,
        "make results-diagnosis DATA=data": NotRun(
            "recordings of real robots, which are not in the repository",
            "make -n results-diagnosis DATA=data",
        ),
    },
    "recordings.md": {
        "groundwalk convert log.csv --out swing.parquet": NotRun(
            "it shows what it makes of a table, and asks",
            "groundwalk convert log.csv --out swing.parquet",
            status=2,
            says="position.elbow  elbow_pos_deg  deg   its name",
        ),
        "groundwalk convert log.csv --out swing.parquet --yes": Run(
            writes=("swing.parquet",), says="joints elbow"
        ),
        "groundwalk convert log.csv --map time=t_ms*ms "
        "position.elbow=elbow_pos_deg*deg command.elbow=elbow_cmd_deg*deg "
        "torque.elbow=none --out elbow.csv": Run(
            writes=("elbow.csv", "elbow.json"), says="time, position, command"
        ),
        "groundwalk convert arm.mcap --state-topic /joint_states "
        "--command-topic /targets --out arm.parquet": Run(
            writes=("arm.parquet",), says="commands from /targets"
        ),
        "groundwalk convert pick_place --unit deg gripper=percent_0_100 "
        "--calibration follower.json --out pick_place_recordings": Run(
            writes=("pick_place_recordings/pick_place_episode_001.parquet",)
        ),
        "groundwalk convert pick_place --unit percent --calibration follower.json "
        "--without gripper --out arm_recordings": Run(
            writes=("arm_recordings/*.parquet",), says="joints shoulder_pan; "
        ),
        "groundwalk convert lift.json --rename pendulum=elbow --out lift.parquet": Run(
            writes=("lift.parquet",), says="joints elbow"
        ),
        "groundwalk convert chirp.npz --joints LF_HAA LF_HFE LF_KFE "
        "--out chirp.parquet": Run(writes=("chirp.parquet",), says="LF_KFE"),
    },
    "architecture.md": {
        "make lint": NotRun("a minute, beside the tests", "make -n lint", says="ruff"),
        "make test": TESTS,
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
