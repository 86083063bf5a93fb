"""What the healthy robot turns out to have becomes known, and the search goes on."""

from types import SimpleNamespace

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
