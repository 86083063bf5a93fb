import hashlib
import json
import shutil
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
from made_once import made_once

from experiments.concealed import draw as concealed_draw
from experiments.concealed import make as concealed_make
from experiments.concealed.draw import CASE_KINDS, PLANTS, CaseSort
from experiments.concealed.make import ConcealedMake, main
from experiments.concealed.motion import CaseMotion
from experiments.runs import processes
from groundwalk.errors import BadValueError, GroundwalkError, RunFolderError
from worlds import read_recording
from worlds.hidden.effects import KINDS
from worlds.hidden.run import run_hidden


@pytest.fixture
def pendulums(monkeypatch):
    """Draw the pendulum only, which is simulated fastest."""
    monkeypatch.setattr(concealed_draw, "PLANTS", {"pendulum": 1.0})


SEED = 44
"""Makes a set of two pendulums, the first with a hidden effect, the second without:
both are made fast."""


def make(folder, cases=2, seed=SEED, which=1):
    """Make a set in this process, where the changes of a test apply."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            processes, "ProcessPoolExecutor", lambda *_, **__: ThreadPoolExecutor(1)
        )
        config = {"cases": cases, "seed": seed, "set": which, "threads": 1}
        main(ConcealedMake(folder=folder, **config))
    return (folder / "sealed.sha256").read_text().split()[0]


def contents(folder):
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A folder with a set of two pendulums; tests leave it unchanged."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(concealed_draw, "PLANTS", {"pendulum": 1.0})
        return made_once(tmp_path_factory, "concealed", make)


def test_a_set_has_its_layout_and_a_sealed_truth(made, capsys):
    folder = made
    digest = make(folder)  # that it is made tells the hash
    sealed = (folder / "sealed" / "truth.json").read_bytes()
    assert hashlib.sha256(sealed).hexdigest() == digest
    assert digest in capsys.readouterr().out
    truth = json.loads(sealed)
    assert sorted(truth["cases"]) == ["case_000", "case_001"]
    assert [len(case["effects"]) for case in truth["cases"].values()] == [1, 0]
    for name, case in truth["cases"].items():
        assert case["kind"] in CASE_KINDS
        assert all(effect["name"] in KINDS for effect in case["effects"])
        plant = json.loads((folder / "cases" / name / "plant.json").read_text())
        assert plant == {"robot": "nominal.xml", "base": "fixed"}
        assert (folder / "cases" / name / "nominal.xml").is_file()
        recordings = sorted((folder / "cases" / name / "recordings").iterdir())
        assert len(recordings) == 4
        for path in recordings:
            recording = read_recording(path)
            assert 7.9 < recording.duration_s < 10.1
            told = recording.metadata.to_json()
            assert not any(effect["name"] in told for effect in case["effects"])
        servos = [read_recording(path).metadata.servo["swing"] for path in recordings]
        assert {servo.max_torque for servo in servos} == {4.0}
        soft, given = sorted({(servo.kp, servo.kd) for servo in servos})
        assert given == pytest.approx((2 * soft[0], 2 * soft[1]))
        assert sum((servo.kp, servo.kd) == soft for servo in servos) == 2


@pytest.mark.slow
@pytest.mark.usefixtures("pendulums")
def test_a_killed_run_goes_on_to_the_same_bits(made, tmp_path, monkeypatch):
    real, truth = concealed_make.make_case, made / "sealed" / "truth.json"

    def killed(which, cases, parts, seed, number, count):
        """The first is made as it was: `test_a_case_does_not_depend...` makes it."""
        if number == 1:
            raise KeyboardInterrupt
        shutil.copytree(made / "cases" / "case_000", cases / "case_000")
        parts.mkdir()
        known = json.loads(truth.read_text())["cases"]["case_000"]
        (parts / "case_000.json").write_text(json.dumps(known))

    monkeypatch.setattr(concealed_make, "make_case", killed)
    with pytest.raises(KeyboardInterrupt):
        make(tmp_path / "broken")
    assert not (tmp_path / "broken" / "sealed.sha256").exists()
    monkeypatch.setattr(concealed_make, "make_case", real)
    make(tmp_path / "broken")
    assert contents(tmp_path / "broken") == contents(made)


@pytest.mark.slow
@pytest.mark.usefixtures("pendulums")
def test_a_case_does_not_depend_on_how_many_there_are(made, tmp_path):
    make(tmp_path / "set", cases=1)
    alone, first, second = (
        contents(folder / "cases" / name)
        for folder, name in (
            (tmp_path / "set", "case_000"),
            (made, "case_000"),
            (made, "case_001"),
        )
    )
    assert alone == first != second


def test_another_set_is_not_touched(made, tmp_path):
    shutil.copytree(made, tmp_path / "set")
    before = contents(tmp_path / "set")
    for other in ({"cases": 2, "seed": 5}, {"cases": 1}, {"which": 2}):
        with pytest.raises(RunFolderError, match="another set"):
            make(tmp_path / "set", **other)
    make(tmp_path / "set")
    assert contents(tmp_path / "set") == before
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "letter.txt").write_text("dear")
    with pytest.raises(RunFolderError, match="not empty"):
        make(tmp_path / "mine", cases=1)


def test_plants_and_kinds_come_as_often_as_they_shall():
    sorts = [CaseSort.drawn(np.random.default_rng([7, i])) for i in range(2000)]
    for kind, share in CASE_KINDS.items():
        found = sum(sort.kind == kind for sort in sorts) / len(sorts)
        assert found == pytest.approx(share, abs=0.03)
    assert {sort.plant for sort in sorts} == set(PLANTS)
    bullet = sum(sort.engine == "bullet" for sort in sorts) / len(sorts)
    assert bullet == pytest.approx(0.5, abs=0.04)


@pytest.mark.parametrize("name", ["pendulum", "so101", "nao_air", "nao_standing"])
def test_two_recordings_in_the_air_have_half_the_gains(name):
    for seed in range(8):
        motion = CaseMotion.drawn(name, False, 1e-3, np.random.default_rng(seed))
        kp = np.array([plant.kp_nm_rad for plant in motion.plants])
        kd = np.array([plant.kd_nm_s_rad for plant in motion.plants])
        emf = np.array([plant.back_emf_nm_s_rad for plant in motion.plants])
        assert (emf == motion.plant.back_emf_nm_s_rad).all()
        if name == "nao_standing":
            assert (kp == motion.plant.kp_nm_rad).all()
            continue
        soft = np.flatnonzero(kp[:, 0] < 0.7 * kp[0, 0])
        assert len(soft) == 2
        assert kp[soft] == pytest.approx(np.stack([kp[0]] * 2) / 2)
        assert kd[soft] == pytest.approx(np.stack([kd[0]] * 2) / 2)


def test_a_soft_servo_sags_as_its_own_gain_says():
    motion = CaseMotion.drawn("pendulum", True, 1e-3, np.random.default_rng(3))
    motion = replace(motion, spans_s=((9.0, 0.2),) * 4)
    for number, plant in enumerate(motion.plants[:2]):
        start_rad, feed = motion.feed(number)
        clock, nobody = motion.clock(number), np.random.SeedSequence(0)
        run = run_hidden(plant, [], "mujoco", clock, feed, start_rad, nobody)
        angle = run.position_rad[-1, 0]
        torque = plant.kp_nm_rad[0] * (run.command_rad[-1, 0] - angle)
        assert torque == pytest.approx(0.5 * 9.81 * 0.3 * np.sin(angle), rel=1e-3)


@pytest.mark.parametrize("held", [True, False])
def test_a_joint_that_is_not_to_be_excited_rests_when_the_recording_begins(held):
    motion = CaseMotion.drawn("pendulum", held, 1e-3, np.random.default_rng(3))
    soft = 1  # of the softer servos, which take longest to rest
    start_rad, feed = motion.feed(soft)
    clock, nobody = motion.clock(soft), np.random.SeedSequence(0)
    run = run_hidden(motion.plants[soft], [], "mujoco", clock, feed, start_rad, nobody)
    reach_rad = np.ptp(run.position_rad[clock.first :])
    assert (reach_rad < 2e-4) == held


@pytest.mark.parametrize(
    "options", [{"cases": 0}, {"seed": -1}, {"threads": -1}, {"set": 3}]
)
def test_sets_that_cannot_be_are_refused(tmp_path, options):
    with pytest.raises(BadValueError):
        ConcealedMake(folder=tmp_path / "set", **options)


def test_a_robot_that_always_falls_is_told(monkeypatch):
    from experiments.concealed import case as concealed_case

    monkeypatch.setattr(concealed_case._Maker, "run", lambda self: False)
    with pytest.raises(GroundwalkError, match="fell"):
        concealed_case.first_case(1, 0, 1)
