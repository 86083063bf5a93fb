"""How commands of the pages on recordings and their diagnosis are run in a test."""

from kinds_of_steps import NotRun, Run, Step, below, make
from small import CONCEALED, CORRECTED, DIAGNOSED, PREDICTED, REAL, SEARCH, SMALL_STUDY


def _bag(command: str, says: str) -> NotRun:
    """A command on a bag of a real robot, and what a small one says in its place."""
    reason = "real bags are not in the repository: test_real_bags_typed.py takes it"
    return NotRun(reason, command, says=says)


RECORDING_STEPS: dict[str, dict[str, Step]] = {
    "check.md": {
        "groundwalk record --robot so101 --motion ramps --duration 20 "
        "--out slow.parquet": Run(writes=("slow.parquet",)),
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
        "groundwalk record --robot pendulum --load link=0.8@0,0,-0.3 --hidden "
        "gear_friction@swing:coulomb_torque=0.05,share=0.1 --out heavy.parquet": Run(
            writes=("heavy.parquet",), says="ticks of pendulum"
        ),
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
        "groundwalk convert lift.json --rename pendulum=elbow "
        "--load lever=0.5@0,0,-0.1 --out lift.parquet": Run(
            writes=("lift.parquet",), says="joints elbow"
        ),
        "groundwalk convert chirp.npz --joints LF_HAA LF_HFE LF_KFE "
        "--out chirp.parquet": Run(writes=("chirp.parquet",), says="LF_KFE"),
        "groundwalk convert arm_episodes --robot my_arm.urdf --servo mx-64@12V,P=32 "
        "--unit deg --out episodes": Run(
            writes=below("episodes", ("arm_episodes_episode_001.parquet",)),
            says="50 rows a second",
        ),
        "groundwalk check episodes": Run(says="can be diagnosed"),
        "groundwalk diagnose episodes --out runs/episodes": Run(
            writes=below("runs/episodes", (*DIAGNOSED, "corrected.xml")),
            says="dry friction at the joint elbow: torque 0.2",
        ),
        "groundwalk convert ur10_exciting.db3 --robot ur10_robot --out ur10.parquet": (
            _bag("groundwalk convert arm.db3 --out arm_again.parquet", "wrote")
        ),
        "groundwalk check ur10.parquet": _bag("groundwalk check --help", "RECORDING"),
        "groundwalk diagnose ur10.parquet --out runs/ur10": _bag(
            "groundwalk diagnose --help", "--drive"
        ),
        "groundwalk convert panda_exciting.db3 --robot panda "
        "--rename 'fer_*=panda_*' --out panda.parquet": _bag(
            "groundwalk convert --help", "--rename"
        ),
        "groundwalk check panda.parquet": _bag("groundwalk check --help", "--servo"),
        "groundwalk diagnose panda.parquet --out runs/panda": _bag(
            "groundwalk diagnose --help", "--reference"
        ),
    },
}
"""By page and by the command as it stands there."""
