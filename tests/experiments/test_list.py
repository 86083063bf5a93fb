import re
import sys

import pytest

import terrain
from experiments.list_names import TABLES, List, main
from groundwalk.errors import UnknownNameError
from worlds.hidden import KINDS, Hidden


def rows_of(kind):
    headings, rows = TABLES[kind]()
    assert all(len(row) == len(headings) for row in rows)
    return [dict(zip(headings, row, strict=True)) for row in rows]


def test_robots():
    rows = {row["robot"]: row for row in rows_of("robots")}
    assert {"talos", "g1", "romeo", "icub", "simple_humanoid"} < set(rows)
    nao = rows["nao"]
    # Facts of the maker: 5.305 kg; 100 + 102.9 + 45.11 mm from hip to sole.
    assert nao == {
        "robot": "nao",
        "mass [kg]": "5.305",
        "leg [m]": "0.248",
        "joints": "20",
    }


def test_servos_with_their_sources():
    rows = {row["servo"]: row for row in rows_of("servos")}
    servo = rows["mx-64@12V,P=32"]
    assert servo["stiffness [N m/rad]"] == "24.9"
    assert all(row["source"] for row in rows.values())


def test_every_terrain_is_there_with_what_can_be_set():
    rows = rows_of("terrains")
    families = [row["terrain"] for row in rows if row["terrain"]]
    assert families == [*terrain.names(), "every terrain"]
    by_name = {row["parameter"]: row for row in rows}
    assert by_name["x_range_m"]["default"] == "-1:5"
    assert by_name["density_per_m2"]["unit"] == "1/m2"
    assert by_name["angle_rad"]["unit"] == "rad"
    steps = by_name["steps"]
    assert [steps[key] for key in ("unit", "default", "from", "to")] == [
        *("1", "5", "1", "1000")
    ]


def test_defaults_can_be_typed_as_they_are_shown():
    name = ""
    tried = 0
    for row in rows_of("terrains"):
        name = row["terrain"] or name
        if row["parameter"]:
            family = "flat" if name == "every terrain" else name
            terrain.parse(f"{family}:{row['parameter']}={row['default']}")
            tried += 1
    assert tried == 3 + 2 + 2 + 3 + 3 + 5


def test_every_hidden_effect_is_there_with_its_place_and_its_parameters():
    rows = rows_of("effects")
    names = [row["effect"] for row in rows if row["effect"]]
    assert names == list(KINDS)
    start = names.index("backlash")
    first = next(i for i, row in enumerate(rows) if row["effect"] == names[start])
    assert rows[first]["where, with"] == "@joint"
    assert "Play" in rows[first]["what it is; values"]
    gap = rows[first + 1]
    assert (gap["where, with"], gap["what it is; values"]) == ("gap", "0 to 0.5 rad")
    soft = next(
        i for i, row in enumerate(rows) if row["effect"] == "contact_compliance"
    )
    assert rows[soft + 2]["what it is; values"] == "0 or more N s/m, optional"


def test_a_hidden_effect_can_be_typed_as_the_list_says():
    typed: dict[str, list[str]] = {}
    for row in rows_of("effects"):
        where = row["where, with"]
        if row["effect"]:
            name = f"{row['effect']}{where}"
            typed[name] = []
        else:
            low = row["what it is; values"].split()[0].replace("any", "0")
            typed[name].append(f"{where}={low}")
    for name, values in typed.items():
        text = f"{name}:{','.join(values)}"
        assert Hidden.parse(text).to_text() == text


def test_gaits():
    rows = rows_of("gaits")
    assert len(rows) == 16
    height = next(row for row in rows if row["parameter"] == "hip_height")
    # As in the 2014 report, which says that 0.20 m and more works.
    assert (height["unit"], height["walk2014"], height["from"]) == ("m", "0.23", "0.2")
    assert all(row["what it does"] for row in rows)


def test_there_is_no_list_of_anything_else():
    with pytest.raises(UnknownNameError, match="did you mean 'gaits'"):
        List("gait")


@pytest.mark.parametrize("kind", TABLES)
def test_into_a_file_go_plain_lines_in_columns(kind, capsys):
    headings, rows = TABLES[kind]()
    main(List(kind))
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == len(rows) + 1
    second = lines[0].index(headings[1])
    for line, row in zip(lines[1:], rows, strict=True):
        assert line[second:].startswith(row[1])
        assert line.endswith(next(text for text in reversed(row) if text))


@pytest.mark.parametrize("kind", TABLES)
def test_on_a_narrow_terminal_only_the_last_column_is_wrapped(
    kind, capsys, monkeypatch
):
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    monkeypatch.setenv("COLUMNS", "80")
    headings, rows = TABLES[kind]()
    main(List(kind))
    out = re.sub(r"\x1b\[[0-9;]*m", "", capsys.readouterr().out)
    assert max(map(len, out.splitlines())) <= 80
    assert all(heading in out for heading in headings)  # also those in brackets
    assert all(text in out for row in rows for text in row[:-1])
