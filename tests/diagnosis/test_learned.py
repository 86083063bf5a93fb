"""What the healthy robot turns out to have becomes known, and the search goes on."""

from types import SimpleNamespace

import numpy as np
from made_up_traces import arm

from diagnosis import learned
from diagnosis.effects.parts import PlacedEffect
from diagnosis.learned import MOST_KNOWN, Learned
from diagnosis.residuals.reference_noise import ReferenceNoise
from diagnosis.search.result import SearchResult
from diagnosis.search.rules import Rules

OLD = PlacedEffect("viscous_friction", "elbow", (0.5,))
NEW = PlacedEffect("servo_gain", "shoulder", (0.8,))
USUAL = PlacedEffect("payload_mass", "lower", (1e-6,))


class Scene:
    """Searches that find NEW, and OLD as well until it is known."""

    def __init__(self, patch, comes_again):
        self.known, self.tried = [], []
        self._comes_again = comes_again
        for name in ("_divided", "found_by", "old_effects", "without", "verdict_kind"):
            patch.setattr(learned, name, getattr(self, name.strip("_")))

    def divided(self, material, channels, rules, *options):
        _, _, promising, known, _ = options
        self.known.append(known)
        self.tried.append([list(model) for model in promising])
        noise = ReferenceNoise.known((USUAL, *(known or ())), 2)
        judge = SimpleNamespace(rules=rules)
        return None, noise, SimpleNamespace(judge=judge)

    def found_by(self, search):
        finds_old = self._comes_again or not self.known[-1]
        model = (NEW, OLD) if finds_old else (NEW,)
        best = {len(model): [SimpleNamespace(model=model)]}
        return SearchResult(9.0, 1.0, best, len(model)), True

    def old_effects(self, judge, result):
        return tuple(one for one in result.winner.model if one is OLD)

    def without(self, judge, result, old):
        self.left_out = old
        return result

    def verdict_kind(self, result, plant, audited):
        return "effects"

    def run(self):
        material = SimpleNamespace(plant=arm(), audited=None)
        return Learned._of(material, None, Rules(), 1, None, [])


def test_what_is_old_becomes_known_and_is_not_found_again(monkeypatch):
    scene = Scene(monkeypatch, comes_again=False)
    found = scene.run()
    assert scene.known == [None, (OLD,)]
    assert scene.tried[1] == [[NEW]]
    assert found.result.winner.model == (NEW,)
    assert scene.left_out == ()


def test_what_comes_again_though_it_is_known_is_left_out(monkeypatch):
    scene = Scene(monkeypatch, comes_again=True)
    scene.run()
    assert scene.known == [None, (OLD,)]
    assert scene.left_out == (OLD,)


def test_what_was_held_to_be_small_becomes_known_if_it_is_large(monkeypatch):
    """The healthy robot has more of what is a usual error as long as it is small."""
    scene = Scene(monkeypatch, comes_again=False)
    large = PlacedEffect(USUAL.name, USUAL.place, (0.3,))
    olds = iter([(large,), ()])
    monkeypatch.setattr(learned, "old_effects", lambda *args: next(olds))
    scene.run()
    assert scene.known == [None, (large,)]


def test_it_ends(monkeypatch):
    """Each time something else is old: what is old last is left out."""
    scene = Scene(monkeypatch, comes_again=True)
    names = "coulomb_friction", "backlash", "joint_spring", "servo_damping"
    others = [PlacedEffect(name, "elbow", (0.5, 0.0)) for name in names]
    found = iter(others)
    monkeypatch.setattr(learned, "old_effects", lambda *args: (next(found),))
    scene.run()
    assert [len(one or ()) for one in scene.known] == list(range(MOST_KNOWN))
    assert scene.left_out == (others[MOST_KNOWN - 1],)


class Left:
    """A search that leaves `times` the noise, and what follows from that."""

    def __init__(self, patch, times, everywhere, creeps=False):
        self.searched, self.trust = [], None
        self.creeps, self.everywhere = creeps, everywhere
        patch.setattr(learned, "precise", lambda plant, traces, channels, threads: self)
        patch.setattr(learned, "_rules", lambda plant, rules: Rules())
        patch.setattr(learned, "_left", lambda data, result: np.array(times))
        patch.setattr(learned, "_divided", self.divided)
        patch.setattr(learned, "_softened", lambda material: "soft")
        patch.setattr(learned, "_best_of_each_size", lambda search, result: [])
        patch.setattr(Learned, "_of", self.of)
        patch.setattr(Learned, "_timed_anew", lambda one: None)
        patch.setattr(Learned, "_creeps", lambda one: self.creeps)

    wider = np.ones(2)

    def widened(self, times):
        return times.tolist()

    def divided(self, material, channels, *options, trust):
        self.trust = trust
        return "data", None, None

    def of(self, material, channels, *options):
        self.searched.append((material, channels))
        squares = {name: np.ones((2, 2)) for name in "abc"}
        squares["c"] = np.array([[4.0, 1.0], [1.0, 1.0]])
        data = SimpleNamespace(
            learned=SimpleNamespace(squares_in=lambda model: squares)
        )
        result = SearchResult(9.0, 1.0, {}, 0)
        parts = data, None, None, result, "effects", self.everywhere
        return Learned(material, *parts)

    def run(self):
        material = SimpleNamespace(plant=None, traces=(), reference=(), channels=None)
        self.material = material
        return Learned.of(material, None, 1, None)


def test_what_is_left_within_twice_the_noise_is_noise(monkeypatch):
    scene = Left(monkeypatch, [1.9, 0.6], everywhere=False)
    assert not scene.run().inexact
    assert scene.searched == [(scene.material, scene)]


def test_what_is_left_beyond_that_is_the_noise_of_another_search(monkeypatch):
    scene = Left(monkeypatch, [5.0, 1.0], everywhere=False)
    scene.run()
    assert scene.searched[1:] == [(scene.material, [5.0, 1.0])]


def test_where_effects_are_everywhere_only_tests_follow(monkeypatch):
    scene = Left(monkeypatch, [5.0, 1.0], everywhere=True)
    found = scene.run()
    assert found.inexact
    assert found.data == "data"
    assert len(scene.searched) == 1
    assert scene.trust["c"].tolist() == [0.5, 1.0]
    assert scene.trust["a"].tolist() == [1.0, 1.0]


def test_beside_friction_that_creeps_what_is_left_is_noise_as_well(monkeypatch):
    scene = Left(monkeypatch, [5.0, 1.0], everywhere=True, creeps=True)
    found = scene.run()
    assert scene.searched == [(scene.material, scene), ("soft", scene)]
    assert (found.inexact, found.material, found.data) == (True, "soft", "data")
