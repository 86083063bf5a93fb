"""Arms recorded with the identical model: cases in which nothing is missing."""

import mujoco
import numpy as np

from experiments.concealed.identical import MOST_JOINTS, MOTIONS, identical_case


def test_joints_drives_and_noise_take_turns():
    made = [identical_case(5, number, 60) for number in (0, 1, MOST_JOINTS, 15)]
    joints = [int(one.truth["plant"].split()[0]) for one in made]
    assert joints == [1, 2, 1, 2]
    drives = [one.truth["plant"].split(", ")[1] for one in made]
    assert drives == ["actuators", "actuators", "loop", "actuators"]
    for one in made:
        assert one.truth["kind"] == "none"
        assert not one.truth["effects"]
        assert not one.reference
        assert len(one.recordings) == len(MOTIONS)


def test_the_model_replays_its_recordings_to_the_noise():
    """MuJoCo itself, in the model's own steps, from where the arm has settled."""
    made = identical_case(5, 1, 60)
    model = mujoco.MjModel.from_xml_string(made.model[1])
    for recording in made.recordings.values():
        data = mujoco.MjData(model)
        joints = recording.joints
        command, position = (
            np.stack([recording.columns[f"{what}.{name}"] for name in joints], axis=1)
            for what in ("command", "position")
        )
        data.qpos[:] = data.ctrl[:] = command[0]
        mujoco.mj_step(model, data, 30_000)
        steps = round((recording.time_s[1] - recording.time_s[0]) / model.opt.timestep)
        left = np.empty_like(position)
        for row, target in enumerate(command):
            left[row] = position[row] - data.qpos
            data.ctrl[:] = target
            mujoco.mj_step(model, data, steps)
        assert 5e-6 < left.std() < 4e-4
        assert np.ptp(position, axis=0).min() > 0.1


def test_a_case_depends_on_seed_and_number_only():
    first, same, other = (identical_case(s, 2, n) for s, n in ((1, 9), (1, 5), (2, 9)))
    assert first.model == same.model != other.model
    for name, recording in first.recordings.items():
        for column, values in recording.columns.items():
            np.testing.assert_array_equal(same.recordings[name].columns[column], values)
