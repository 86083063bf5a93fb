"""Tests corrected_laws.py: with corrected.xml it moves as the diagnosis' own sim did.

Run `pytest test_corrected_laws.py` in this folder. `corrected_laws_test.npz` has the
commands of one recording's first seconds and what the sim of the diagnosis, which does
not share code with corrected_laws.py, made of them.
"""

import importlib
import sys
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

FOLDER = Path(__file__).parent


def simulated(without_laws: bool = False) -> npt.NDArray[np.float64]:
    """(steps + 1, j) angles [rad] as encoders show them before and after each step."""
    sys.path.insert(0, str(FOLDER))
    module: Any = importlib.import_module("corrected_laws")
    model = mujoco.MjModel.from_xml_path(str(FOLDER / "corrected.xml"))
    # options of the diagnosis, which may differ from those of your model
    model.opt.integrator = int(expected("integrator"))
    model.opt.disableflags = int(expected("disableflags"))
    model.dof_solref[:] = expected("dof_solref")
    model.dof_solimp[:] = expected("dof_solimp")
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = expected("qpos"), expected("qvel")
    data.time = float(expected("start_s"))
    parts = () if without_laws else module.LAWS
    laws = module.CorrectedLaws(model, data, module.BACK_EMF_NM_S_RAD, parts)
    names = [str(name) for name in expected("joints")]
    _hold(model, data, dict(zip(names, expected("targets_rad")[0], strict=True)))
    found = [expected("position_rad")[0]]
    for targets, torques in zip(
        expected("targets_rad"), expected("torques_nm"), strict=True
    ):
        named = (dict(zip(names, one, strict=True)) for one in (targets, torques))
        laws.before_step(*named)
        mujoco.mj_step(model, data)
        readings = laws.readings()
        found.append(np.array([readings[name][0] for name in names]))
    return np.array(found)


def _hold(
    model: mujoco.MjModel, data: mujoco.MjData, targets: dict[str, float]
) -> None:
    """Let delayed actuators have had these targets before the start."""
    for name, target in targets.items():
        actuator = model.actuator(name).id
        if model.actuator_delay[actuator] > 0:
            samples = np.full(model.actuator_history[actuator, 0], target)
            mujoco.mj_initCtrlHistory(model, data, actuator, None, samples)


def expected(name: str) -> Any:
    """What the sim of the diagnosis gave, or was given, by its name."""
    return np.load(FOLDER / "corrected_laws_test.npz")[name]


def largest_error(without_laws: bool = False) -> npt.NDArray[np.float64]:
    """(j,) largest difference [rad] from the sim of the diagnosis."""
    error = np.abs(simulated(without_laws) - expected("position_rad"))
    largest: npt.NDArray[np.float64] = error[expected("first_row") :].max(axis=0)
    return largest


def test_it_moves_as_the_sim_of_the_diagnosis() -> None:
    """Within 0.1 mrad, a third of the noise of good encoders.

    Both take the same steps of the same laws, so that little more than rounding should
    remain. Where encoders are late by a part of a step, the two interpolate by other
    cubics, and `tolerance_rad` is larger by what these can differ. Where late encoders
    still show what was before the start nothing is compared.
    """
    assert largest_error().max() <= expected("tolerance_rad"), largest_error()


def test_without_the_laws_it_does_not() -> None:
    """Unless they are too small to show in these seconds."""
    differs = largest_error(without_laws=True).max() > expected("tolerance_rad")
    assert differs or not expected("laws_show")
