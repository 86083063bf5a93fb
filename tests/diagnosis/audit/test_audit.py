import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from audited_arm import HZ, QUANTUM, SECONDS, changed, one, servo, texts

from diagnosis.audit.audit import audit
from diagnosis.traces.read import read_traces
from diagnosis.traces.trace import Trace
from worlds.recordings.load import Load
from worlds.recordings.metadata import ServoGains

DATA = Path(__file__).parents[4] / "shared" / "data"


def test_good_trace_has_no_findings(trace, plant):
    result = audit([trace], plant)
    assert result.findings == ()
    assert result.refused == () == result.limits
    (found,) = result.traces
    assert found.rate_hz == pytest.approx(HZ)
    assert found.jitter_s < 1e-9
    assert found.rows == HZ * SECONDS
    channels = {channel.name: channel for channel in found.channels}
    assert len(channels) == 9
    assert channels["position.a"].quantum == pytest.approx(QUANTUM, rel=1e-4)
    assert channels["velocity.b"].noise_std == pytest.approx(0.01, rel=0.15)
    assert channels["velocity.b"].quantum is None


def test_a_load_is_noted(trace, plant):
    loaded = replace(trace, loads={"hand": Load(0.5, (0.0, 0.1, -0.25))})
    (found,) = audit([loaded], plant).findings
    assert found.severity == "note"
    assert "hand carries 0.5 kg at (0, 0.1, -0.25) m" in found.text


def test_motion_is_measured(trace, plant):
    joint = audit([trace], plant).traces[0].joints[1]
    assert joint.name == "b"
    assert joint.moves
    assert joint.low_rad == pytest.approx(-0.1, abs=0.01)
    assert joint.high_rad == pytest.approx(0.5, abs=0.01)
    assert joint.speed_rad_s == pytest.approx(0.3 * 2 * np.pi * 1.1, rel=0.03)
    assert joint.reversals == 2 * round(1.1 * SECONDS)


def test_json_is_plain(trace, plant):
    text = audit([trace], plant).to_json()
    document = json.loads(text)
    assert document["traces"][0]["channels"][0]["name"] == "position.a"
    assert document["findings"] == []


def test_jitter_and_gaps(trace, plant):
    rng = np.random.default_rng(1)
    jitter = replace(trace, time_s=trace.time_s + rng.uniform(-1e-3, 1e-3, trace.ticks))
    # the difference of two uniform values within +-1 ms
    std = 1e-3 * np.sqrt(2 / 3)
    assert audit([jitter], plant).traces[0].jitter_s == pytest.approx(std, rel=0.1)
    uneven = replace(jitter, time_s=trace.time_s + 2 * (jitter.time_s - trace.time_s))
    one(texts([uneven], plant, "limit"), "vary by")
    late = trace.time_s + 0.5 * (trace.time_s > 10)
    text = one(texts([replace(trace, time_s=late)], plant, "limit"), "gap")
    assert "1 gaps" in text
    assert "510 ms" in text


@pytest.mark.parametrize(
    ("stop", "stride", "word"),
    [(90, 1, "lasts 0.89 s"), (400, 10, "40 rows"), (1, 1, "1 rows")],
)
def test_too_little_is_refused(trace, plant, stop, stride, word):
    rows = slice(None, stop, stride)
    short = Trace(
        "short",
        trace.time_s[rows],
        trace.position_rad[rows],
        servo(),
        command_rad=trace.command_rad[rows],
    )
    one(texts([short], plant, "refuse"), word)


def test_slow_rows_limit_what_is_said(trace, plant):
    slow = Trace(
        "slow",
        trace.time_s[::4],
        trace.position_rad[::4],
        servo(),
        command_rad=trace.command_rad[::4],
    )
    one(texts([slow], plant, "limit"), "25 rows a second", "armature")


def test_time_backwards_and_in_milliseconds(trace, plant):
    time_s = trace.time_s.copy()
    time_s[500] = time_s[498]
    text = one(texts([replace(trace, time_s=time_s)], plant, "refuse"), "row 500")
    assert "does not run forward" in text
    milli = replace(trace, time_s=1e3 * trace.time_s)
    one(texts([milli], plant, "refuse"), "milliseconds")


def test_missing_values(trace, plant):
    position = trace.position_rad.copy()
    position[300:340, 0] = np.nan
    text = one(
        texts([replace(trace, position_rad=position)], plant, "limit"), "position.a"
    )
    assert "2.0% of the values are missing, up to 0.41 s" in text
    position[: int(0.6 * trace.ticks), 1] = np.nan
    found = texts([replace(trace, position_rad=position)], plant, "refuse")
    one(found, "position.b", "60%")


def test_a_scattered_gap_is_only_noted(trace, plant):
    position = trace.position_rad.copy()
    position[::50, 0] = np.nan
    bad = replace(trace, position_rad=position)
    one(texts([bad], plant, "note"), "position.a", "2.0%")
    assert texts([bad], plant, "limit") == []


def test_constant_channels(trace, plant):
    dead = replace(trace, position_rad=changed(trace.position_rad, 0, 0.1))
    dead = replace(dead, velocity_rad_s=None)
    found = audit([dead], plant)
    one(found.limits, "position.a of good never changes although its command does")
    one(found.limits, "a never moves", "friction")
    assert found.refused == ()
    none = replace(dead, position_rad=np.full_like(trace.position_rad, 0.1))
    assert len(audit([none], plant).refused) == 3


def test_a_joint_that_nobody_moves(trace, plant):
    still = replace(
        trace,
        position_rad=changed(trace.position_rad, 0, QUANTUM),
        command_rad=changed(trace.command_rad, 0, 0.0),
        velocity_rad_s=None,
    )
    assert texts([still], plant, "refuse") == []
    one(texts([still], plant, "limit"), "a never moves", "friction")
    # another trace moves it
    assert texts([still, trace], plant, "limit") == []


def test_no_reversals(trace, plant):
    ramp = 0.04 * trace.time_s - 0.4
    rising = replace(
        trace,
        position_rad=changed(trace.position_rad, 2, ramp),
        command_rad=changed(trace.command_rad, 2, ramp),
        velocity_rad_s=None,
    )
    one(texts([rising], plant, "limit"), "c reverses 0 times", "Coulomb")


def test_channels_without_any_value(trace, plant):
    empty = replace(
        trace,
        position_rad=np.full_like(trace.position_rad, np.nan),
        accelerometer_m_s2=np.full((trace.ticks, 3), np.nan),
    )
    found = texts([empty], plant, "refuse")
    assert (
        len([text for text in found if "100% of the values are missing" in text]) == 3
    )


def test_floating_base_needs_its_pose(trace, plant):
    floating = replace(plant, base="floating")
    one(texts([trace], floating, "refuse"), "base.position")
    posed = replace(
        trace,
        base_position_m=np.zeros((trace.ticks, 3)),
        base_orientation=np.tile([1.0, 0, 0, 0], (trace.ticks, 1)),
    )
    assert texts([posed], floating, "refuse") == []


def test_beyond_the_model_s_range(trace, plant):
    # the range is +-1.745
    high = changed(trace.position_rad, 0, trace.position_rad[:, 0] + 1.6)
    beyond = replace(trace, position_rad=high)
    assert texts([beyond], plant, "refuse") == []
    one(texts([beyond], plant, "limit"), "position.a", "beyond its range")
    spike = trace.position_rad.copy()
    spike[700, 0] = 100.0
    spiked = replace(trace, position_rad=spike, velocity_rad_s=None)
    assert not any("beyond" in text for text in texts([spiked], plant, "refuse"))


def test_a_range_in_degrees_that_should_be_radians(trace, plant):
    """Joints move 0.8 rad within +-1.745, which would be read as +-0.03 rad."""
    spec = plant.spec.copy()
    spec.joint("a").range = plant.model.joint("a").range  # MJCF expects degrees
    narrow = replace(plant, spec=spec)
    text = one(texts([trace], narrow, "refuse"), "position.a", "in degrees where")
    assert "-0.0305 to 0.0305" in text
    spec.joint("a").range = np.degrees([-0.2, 0.2])  # an end stop may give way
    assert texts([trace], replace(plant, spec=spec), "refuse") == []


@pytest.mark.slow
@pytest.mark.parametrize(
    ("pattern", "source", "servo"),
    [
        ("so101/*.parquet", "so101", ServoGains(15.0, 1.0, 3.0)),
        ("go2/*.parquet", "go2", ServoGains(20.0, 1.5, 45.0)),
        ("emps/*.parquet", DATA / "emps" / "emps.xml", None),
    ],
)
def test_real_recordings_are_accepted(pattern, source, servo):
    paths = sorted(DATA.glob(pattern))
    if not paths:
        pytest.skip(f"no recordings of {pattern} in ../shared/data")
    plant, traces = read_traces(paths, source, servo)
    result = audit(traces, plant)
    assert result.refused == ()
    if source == "so101":
        channels = [channel for one in result.traces for channel in one.channels]
        quanta = [
            channel.quantum
            for channel in channels
            if channel.quantum and channel.name.startswith("position.")
        ]
        # a servo's 4096 steps a turn
        np.testing.assert_allclose(quanta, 2 * np.pi / 4096, rtol=1e-3)
        assert len(quanta) > 50
