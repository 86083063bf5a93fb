"""Writes the files of a diagnosis that others simulate with: models, laws, a table."""

from collections.abc import Mapping

from diagnosis import Diagnosis
from diagnosis.corrected.effects_json import CORRECTED_JSON, Correction
from diagnosis.corrected.joint_table import CORRECTED_JOINTS, joints_csv
from diagnosis.corrected.laws_file import CORRECTED_LAWS, laws_text
from diagnosis.corrected.laws_test_file import (
    TEST_LAWS,
    TEST_LAWS_NPZ,
    expected_npz,
    text_of_test,
)
from diagnosis.corrected.mjcf import CORRECTED_XML, corrected_mjcf
from diagnosis.effects import effect
from diagnosis.verdict import Found
from experiments.runs.extras import extra
from experiments.runs.folder import RunFolder
from groundwalk.files import write_bytes

FILES: Mapping[str, str] = {
    CORRECTED_XML: "the corrected model, with the effects that MuJoCo has",
    CORRECTED_LAWS: "the other effects, for NumPy and MuJoCo alone",
    TEST_LAWS: "tests that file, with pytest",
    CORRECTED_JOINTS: "each joint's values, for other simulators",
    CORRECTED_JSON: "all effects found, for the option --sim",
}
"""What each of the files is, by its name; a run has some of them or none."""


def how_simulated(found: Found) -> str:
    """Which file simulates an effect that MuJoCo lacks; "" if MuJoCo has it."""
    if found.native:
        return ""
    lacking, why = "MuJoCo does not have it", why_in_no_file(found)
    if why:
        return f"{lacking}, and no file for other simulators does: {why}."
    return f"{lacking}: {CORRECTED_LAWS} adds it before each step."


def why_in_no_file(found: Found) -> str:
    """Why no file for other simulators has an effect; "" if one does."""
    if found.native:
        return ""
    only = found.when.recording
    return f"it happened in {only} only" if only else effect(found.name).no_law


def write_correction(folder: RunFolder, found: Diagnosis) -> None:
    """Write what corrects the nominal model into a run folder, if anything does.

    If a file cannot be written, one line says so, and the others are written.
    """
    if not found.verdict.effects:
        return
    plant, first = found.plant, found.test.traces[0]
    servo = plant.servo if first.unheld else first.servo
    model = (*found.given, *found.nuisance, *found.model)
    with extra(CORRECTED_XML):
        folder.write_text(CORRECTED_XML, corrected_mjcf(plant, model, servo))
    with extra(CORRECTED_JSON):
        folder.write_text(CORRECTED_JSON, Correction.of(plant, model).to_json())
    with extra(CORRECTED_JOINTS):
        table = joints_csv(plant, model, found.verdict.effects, servo)
        folder.write_text(CORRECTED_JOINTS, table)
    with extra(CORRECTED_LAWS):
        laws = laws_text(plant, model, servo)
        if laws:
            folder.write_text(CORRECTED_LAWS, laws)
    if not folder.has(CORRECTED_LAWS) or first.unheld:
        return  # without servos nothing follows the targets that the test would give
    with extra(TEST_LAWS):
        write_bytes(folder.path / TEST_LAWS_NPZ, expected_npz(plant, model, first))
        folder.write_text(TEST_LAWS, text_of_test())
