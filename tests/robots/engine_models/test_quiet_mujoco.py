import json
import subprocess
import sys

import mujoco
import pytest

from robots.engine_models.mjcf import quiet_mujoco

PENDULUM = """
<mujoco>
  <worldbody>
    <body>
      <joint axis="0 1 0"/>
      <geom type="capsule" fromto="0 0 0 0.3 0 -0.4" size="0.03"/>
    </body>
  </worldbody>
</mujoco>
"""
OLD = PENDULUM.replace("<worldbody>", '<compiler settotalmass="3"/><worldbody>')
"""A model with an attribute about which MuJoCo 4 warns."""

SWING = f"""
import json, mujoco
model = mujoco.MjModel.from_xml_string({PENDULUM!r})
data = mujoco.MjData(model)
mujoco.mj_step(model, data, nstep=100)
step = data.timer[int(mujoco.mjtTimer.mjTIMER_STEP)]
print(json.dumps([step.duration, data.qpos[0], data.qvel[0]]))
"""
"""Prints the time of 100 steps by MuJoCo's own clock, and where they lead."""


@pytest.fixture
def logging_to_file():
    """MuJoCo's own default, which `quiet_mujoco` switches off."""
    log = mujoco.MjLogConfig.get()
    before = log.logto_file
    log.logto_file = True
    log.set()
    yield
    log.logto_file = before
    log.set()


@pytest.mark.usefixtures("logging_to_file")
def test_mujoco_logs_into_no_file_once_it_is_quiet(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    mujoco.MjModel.from_xml_string(OLD)
    assert [path.name for path in tmp_path.iterdir()] == ["MUJOCO_LOG.TXT"]
    (tmp_path / "MUJOCO_LOG.TXT").unlink()
    capfd.readouterr()
    quiet_mujoco()
    mujoco.MjModel.from_xml_string(OLD)
    assert list(tmp_path.iterdir()) == []
    assert capfd.readouterr() == ("", "")


def swung(before=""):
    """What `SWING` prints in a process of its own, after a line of code."""
    command = [sys.executable, "-c", before + SWING]
    return json.loads(subprocess.run(command, capture_output=True, check=True).stdout)


def test_a_quiet_mujoco_reads_no_clock_and_moves_the_same():
    usual_s, *usual = swung()
    quiet = "from robots.engine_models.mjcf import quiet_mujoco; quiet_mujoco()"
    quiet_s, *same = swung(quiet)
    assert usual_s > 0
    assert quiet_s == 0
    assert same == usual
