"""What `import diagnosis` offers, and what it costs."""

import subprocess
import sys

import pytest

import diagnosis


@pytest.mark.parametrize("name", diagnosis.__all__)
def test_every_name_is_there_and_shows_how_it_is_used(name):
    words = getattr(diagnosis, name).__doc__
    assert "Example" in words or "See docs/" in words


def test_the_face_is_loaded_when_it_is_used():
    code = "import diagnosis, sys; print(*sys.modules, sep='\\n')"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert not {"mujoco", "scipy", "numpy"} & set(done.stdout.splitlines())


def test_a_name_that_is_not_there():
    with pytest.raises(AttributeError, match="no attribute 'diagnosis'"):
        _ = diagnosis.diagnosis
