"""Effects of somebody else's."""

import pytest

from diagnosis.effects import all_effects, also_known, effect
from diagnosis.effects.friction import ViscousFriction
from groundwalk.errors import BadValueError, UnknownNameError


class Molasses(ViscousFriction):
    """Thick and sweet.

    Not known elsewhere.
    """

    name = "thick_molasses"


def test_an_effect_is_known_within_the_block_alone():
    before = dict(all_effects())
    with also_known(Molasses()):
        assert isinstance(effect("thick_molasses"), Molasses)
        words = effect("thick_molasses").words
        assert words.label == "thick molasses"
        assert words.finding == "{joint} has thick molasses {lacking}"
        assert words.meaning == "Thick and sweet."
    assert before == all_effects()
    with pytest.raises(UnknownNameError, match="thick_molasses"):
        effect("thick_molasses")


def test_an_error_within_the_block_leaves_nothing_behind():
    with pytest.raises(ZeroDivisionError), also_known(Molasses()):
        raise ZeroDivisionError
    assert "thick_molasses" not in all_effects()


def test_no_effect_takes_anothers_name():
    with (
        pytest.raises(BadValueError, match="there is an effect 'viscous_friction'"),
        also_known(Molasses(), ViscousFriction()),
    ):
        pass
    assert isinstance(effect("viscous_friction"), ViscousFriction)
    assert "thick_molasses" not in all_effects()
