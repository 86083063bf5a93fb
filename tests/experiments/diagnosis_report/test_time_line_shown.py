from dataclasses import replace

import made_up_diagnoses as made_up
from html_page import Page
from rerun.chunk import RrdReader

from diagnosis.traces.time_line import Stretch
from experiments.diagnosis_report.overlay import state_lanes, write_overlay
from experiments.diagnosis_report.page import write_report
from experiments.diagnosis_report.time_line_figure import (
    MOST_EVENTS,
    MOST_ROWS,
    drawn_recordings,
    event_words,
    time_line_shown,
)

PULSE = Stretch("walk", 3.1, 3.6, "pulse", "elbow", "2 N m (actuator input)")
LINE = [
    Stretch("walk", 0.0, 10.0, "fitted"),
    Stretch("walk", 10.2, 15.0, "held out"),
    PULSE,
    Stretch("walk", 12.0, 12.0, "stall", why="from here on all joints follow later"),
]


def test_events_in_words():
    assert event_words(PULSE) == (
        "walk, 3.1 to 3.6 s: pulse at elbow, 2 N m (actuator input)"
    )
    push = Stretch("walk", 3.1, 3.6, "effect", "hand", "external_force")
    assert event_words(push) == "walk, 3.1 to 3.6 s: push from outside at hand"
    assert event_words(LINE[-1]).startswith("walk, 12 s: stall, from here on")


def test_the_page_draws_time_lines_and_lists_events(tmp_path):
    for line, there in ((LINE, True), ((), False)):
        path = tmp_path / f"{there}.html"
        write_report(path, made_up.EFFECTS, [], made_up.FACTS, time_line=line)
        text = path.read_text()
        assert ("What was used, and what was left out" in text) == there
        assert ("pulse at elbow" in text) == there
        page = Page(text)
        assert (page.open, page.wrong) == ([], [])


def test_many_recordings_and_events_are_counted():
    many = [Stretch(f"walk_{k}", 0.0, 10.0, "fitted") for k in range(MOST_ROWS + 3)]
    last = many[-1].recording
    many += [replace(PULSE, recording=last)] * (MOST_EVENTS + 2)
    assert last in drawn_recordings(many)
    assert len(drawn_recordings(many)) == MOST_ROWS
    shown = time_line_shown(many)
    assert (shown["more_recordings"], shown["more_events"]) == (3, 2)
    assert len(shown["events"]) == MOST_EVENTS


def series():
    one = made_up.series(duration_s=1.0)
    return replace(one, recording="walk", time_s=one.time_s - one.time_s[0] + 11.5)


def test_lanes_hold_what_happened_while_the_recording_was_held_out():
    lanes = state_lanes(series(), LINE, "missing physics found", "state")
    by_path = {lane.path: lane.changes for lane in lanes}
    assert set(by_path) == {"state/verdict", "state/stall"}
    (begin, words), (end, none) = by_path["state/stall"]
    assert begin == 0.5
    assert "follow later" in words
    assert end > begin
    assert none == ""


def test_states_are_in_the_file_beside_the_errors(tmp_path):
    path = tmp_path / "overlay.rrd"
    write_overlay(path, [series()], time_line=LINE, verdict="missing physics found")
    (states,) = (
        chunk.to_record_batch().column("StateChange:state").to_pylist()
        for chunk in RrdReader(path).stream().to_chunks()
        if chunk.entity_path.endswith("/state/verdict")
    )
    assert states == [["missing physics found"]]
    (layout,) = RrdReader(path).blueprints()
    name = "ViewBlueprint:class_identifier"
    kinds = [
        chunk.to_record_batch().column(name).flatten().to_pylist()
        for chunk in RrdReader(path).stream(store=layout).to_chunks()
        if name in chunk.to_record_batch().schema.names
    ]
    assert ["StateTimeline"] in kinds
