import pytest
from three_sines import KD, KP, LIMIT, XML, swing

from diagnosis.plant.load import load_plant
from worlds.recordings.metadata import ServoGains


@pytest.fixture(scope="module")
def plant(tmp_path_factory):
    path = tmp_path_factory.mktemp("pendulum") / "pendulum.xml"
    path.write_text(XML)
    return load_plant(path, "fixed", servo=ServoGains(KP, KD, LIMIT))


@pytest.fixture(scope="module")
def clean(plant):
    return [swing(plant, 0), swing(plant, 1)]


@pytest.fixture(scope="module")
def dry(plant):
    return [swing(plant, seed, dry=0.15) for seed in (0, 1)]
