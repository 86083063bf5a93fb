"""What set 2 draws: small mismatch in every case, and effects that can be told."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.effects.library import all_effects
from diagnosis.plant.load import load_plant
from diagnosis.traces.read import trace_of
from experiments.concealed.second.draw import drawn_slots
from experiments.concealed.second.motion import SecondMotion
from experiments.concealed.second.nuisance import (
    EXACT,
    FRICTION_SHARE,
    GAIN_SHARE,
    MASS_SHARE,
    Nuisance,
)
from experiments.concealed.second.plan import KINDS_2, RATES_HZ, CasePlan
from worlds.hidden import KINDS
from worlds.hidden.recorded import HiddenSensors, Log, hidden_recording
from worlds.hidden.run import run_hidden
from worlds.hidden.scales import scales
from worlds.recordings.metadata import RecordingMetadata

LEARNED = {"presliding", "cogging", "late_reading", "integral_term", "dead_band"}
"""What was outside the library when the set was drawn, and is not any more."""
PLAN = CasePlan("single", "so101", 100, "servos", 1, False, "mujoco")
TORQUES = replace(PLAN, robot="z1", drive="torques")


def rng(*seed):
    return np.random.default_rng(list(seed))


def scene(plan):
    """Motion, run and scales of a short nominal motion."""
    drawn = SecondMotion.drawn(plan, rng(3))
    motion = replace(drawn.motion, spans_s=((0.3, 2.0),) * 4)
    start_rad, feed = motion.feed(0)
    clock, nobody = motion.clock(0, 0.001), np.random.SeedSequence(0)
    plant = motion.plants[0]
    run = run_hidden(plant, [], "mujoco", clock, feed, start_rad, nobody)
    return drawn, run, scales(plant, [run])


@pytest.fixture(scope="module", params=[PLAN, TORQUES], ids=["servos", "torques"])
def seen(request, tmp_path_factory):
    """A plan, its scene, and the plant and traces as the diagnosis sees them."""
    plan = request.param
    drawn, run, measured = scene(plan)
    plant = drawn.motion.plant
    source = tmp_path_factory.mktemp("plants") / plant.file[0]
    source.write_text(plant.file[1])
    torques = plan.drive == "torques"
    servo = {} if torques else plant.servo
    metadata = RecordingMetadata(str(source), "fixed", "test", servo=servo)
    log, sensors = Log(None, torques), HiddenSensors()
    recording = hidden_recording(plant, run, [], sensors, rng(1), metadata, log)
    loaded = load_plant(source, "fixed", recording.joints)
    return plan, drawn, measured, loaded, [trace_of(recording, loaded, "one")]


def cases(plan, drawn, measured, count):
    for number in range(count):
        for kind in ("single", "pair", "triple", "outside"):
            own = replace(plan, kind=kind)
            plant = drawn.motion.plant
            slots = drawn_slots(own, plant, measured, [number, 7])
            yield kind, slots, [s.sized(plant, measured, 0.5, 8.0) for s in slots]


def test_every_truth_is_one_that_the_diagnosis_can_say_or_is_outside(seen):
    plan, drawn, measured, plant, traces = seen
    names = set()
    for kind, _, effects in cases(plan, drawn, measured, 60):
        for effect in effects:
            names.add(effect.name)
            if kind == "outside":
                assert KINDS[effect.name].outside
                assert (effect.name in all_effects()) == (effect.name in LEARNED)
            if effect.name not in all_effects():
                continue
            known = all_effects()[effect.name]
            assert effect.place in known.places(plant, traces), effect
            for parameter in known.parameters(plant, effect.place):
                value = effect[parameter.name]
                assert parameter.low <= value <= parameter.high, effect
    assert len(names) > 15
    if plan.drive == "torques":
        assert all(KINDS[name].in_torques for name in names)
        assert not names & {"servo_gain", "command_latency", "integral_term"}


def test_compounds_have_as_many_effects_as_they_say_and_outside_cases_all_kinds(seen):
    plan, drawn, measured, *_ = seen
    outside = set()
    for kind, slots, effects in cases(plan, drawn, measured, 60):
        assert len(slots) == {"single": 1, "pair": 2, "triple": 3, "outside": 1}[kind]
        assert len({effect.name for effect in effects}) == len(effects)
        if kind == "outside":
            outside |= {effect.name for effect in effects}
        else:
            assert not any(KINDS[effect.name].outside for effect in effects)
    wanted = {"presliding", "position_ripple", "link_flexibility", "late_reading"}
    assert wanted | {"encoder_outliers"} <= outside
    if plan.drive == "servos":
        assert {"integral_term", "dead_band", "joint_crosstalk"} <= outside


def test_nothing_is_drawn_where_nothing_is_hidden(seen):
    plan, drawn, measured, *_ = seen
    own = replace(plan, kind="none")
    assert drawn_slots(own, drawn.motion.plant, measured, [1]) == ()


def test_an_effect_of_another_size_is_the_same_otherwise(seen):
    plan, drawn, measured, *_ = seen
    plant = drawn.motion.plant
    for number in range(20):
        (slot,) = drawn_slots(plan, plant, measured, [number])
        small, large = (slot.sized(plant, measured, e, 8.0) for e in (0.2, 0.8))
        assert (small.name, small.place) == (large.name, large.place) == slot.at(plant)
        if slot.name == "com_offset":
            one, other = (np.array([e[a] for a in "xyz"]) for e in (small, large))
            assert np.cross(one, other) == pytest.approx(np.zeros(3), abs=1e-12)


# The small mismatch


def mismatch(plan, seed=0):
    drawn, _, measured = scene(plan)
    plant = drawn.motion.plant
    torques = plan.drive == "torques"
    return plant, measured, Nuisance.drawn(plant, measured, torques, rng(seed))


@pytest.mark.parametrize("plan", [PLAN, TORQUES], ids=["servos", "torques"])
def test_every_robot_has_all_of_the_small_mismatch(plan):
    plant, measured, small = mismatch(plan)
    model = plant.make_spec().compile()
    for name, more in small.extra_kg.items():
        share = abs(more) / float(model.body(name).mass[0])
        assert MASS_SHARE[0] <= share <= MASS_SHARE[1]
    assert set(small.extra_kg) == set(plant.links)
    found = {(one.name, one.place): one for one in small.effects}
    for i, joint in enumerate(plant.joints):
        dry = found["coulomb_friction", joint]["torque"]
        least = 0.02 * plant.max_torque_nm[i]
        usual = max(measured.torque_nm[i], least)
        assert FRICTION_SHARE[0] <= dry / usual <= FRICTION_SHARE[1]
        assert found["viscous_friction", joint]["coefficient"] > 0
        if plan.drive == "servos":
            for name in ("servo_gain", "servo_damping"):
                assert abs(found[name, joint]["factor"] - 1) <= GAIN_SHARE
    if plan.drive == "torques":
        assert not any(name.startswith("servo") for name, _ in found)
        assert np.abs(small.torque_gain - 1).max() <= GAIN_SHARE
    else:
        assert small.torque_gain is None


def test_the_truth_tells_the_mismatch_in_words_of_an_answer():
    plant, _, small = mismatch(TORQUES)
    told = small.told(plant, 2e-4)
    names = {one["name"] for one in told}
    assert names == {
        "payload_mass",
        "coulomb_friction",
        "viscous_friction",
        "torque_scale",
        "time_jitter",
    }
    assert told[-1]["parameters"] == {"spread": 2e-4}
    assert len(told) == 4 * len(plant.joints) + 1


def test_what_is_hidden_takes_the_place_of_small_mismatch_of_its_kind():
    plant, _, small = mismatch(PLAN)
    joint, body = plant.joints[1], plant.links[2]
    rest = small.beside([("stribeck_friction", joint), ("payload_mass", body)])
    gone = {(one.name, one.place) for one in small.effects}
    gone -= {(one.name, one.place) for one in rest.effects}
    assert gone == {("coulomb_friction", joint)}
    assert set(small.extra_kg) - set(rest.extra_kg) == {body}
    assert EXACT.effects == ()


# Noise, clocks and gains


def test_noise_and_clock_do_not_depend_on_what_is_hidden():
    for kind in KINDS_2:
        one = SecondMotion.drawn(PLAN, rng(5))
        other = SecondMotion.drawn(replace(PLAN, kind=kind), rng(5))
        assert one.sensors == other.sensors
        assert one.motion.jitter_s == other.motion.jitter_s
        assert one.motion.spans_s == other.motion.spans_s


@pytest.mark.parametrize("rate_hz", RATES_HZ)
@pytest.mark.parametrize("drive", ["servos", "torques"])
def test_true_ticks_jitter_about_even_ones_at_every_rate(rate_hz, drive):
    plan = replace(PLAN, rate_hz=rate_hz, drive=drive)
    for seed in range(12):
        drawn = SecondMotion.drawn(plan, rng(seed))
        clock = drawn.motion.clock(0, drawn.step_s)
        rows = (np.arange(len(clock.ticks)) - clock.first)[clock.first :]
        even_s = rows / (rate_hz * drawn.every)
        off_s = clock.time_s[clock.first :] - even_s
        assert 0 < np.ptp(off_s) <= 2 * 0.1 / rate_hz + drawn.step_s
        assert len(rows) / drawn.every / rate_hz >= 8.0


@pytest.mark.parametrize(("gains", "kinds"), [(1, 1), (2, 2)])
def test_recordings_have_one_known_gain_or_two(gains, kinds):
    drawn = SecondMotion.drawn(replace(PLAN, gains=gains), rng(1))
    kp = {float(plant.kp_nm_rad[0]) for plant in drawn.motion.plants}
    assert len(kp) == kinds
    assert max(kp) / min(kp) == pytest.approx(gains)
    assert drawn.controller == ()


def test_an_unknown_controller_has_other_gains_for_all_recordings():
    drawn = SecondMotion.drawn(TORQUES, rng(1))
    names = {one.name for one in drawn.controller}
    assert {"servo_gain", "servo_damping"} <= names
    assert drawn.motion.rate_hz >= 400
    assert drawn.motion.rate_hz / drawn.every == TORQUES.rate_hz


def test_the_healthy_robot_moves_otherwise():
    drawn = SecondMotion.drawn(PLAN, rng(1))
    seeds = {*drawn.motion.seeds, *drawn.before.seeds}
    assert len(seeds) == 8


def test_compounds_need_no_confusable_pair():
    """In torques from Bullet none can be told at some arms: making sets ended here."""
    plan = replace(TORQUES, robot="two_dof", rate_hz=30, engine="bullet")
    drawn, _, measured = scene(plan)
    for kind, count in (("pair", 2), ("triple", 3)):
        own = replace(plan, kind=kind)
        for number in range(20):
            slots = drawn_slots(own, drawn.motion.plant, measured, [number])
            assert len({slot.name for slot in slots}) == count
