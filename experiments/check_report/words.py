"""The tables and sentences of a check of recordings, for console and page."""

from collections.abc import Sequence

from diagnosis.check.result import Check, Proposed, Size
from diagnosis.effects import PlacedEffect
from diagnosis.effects import effect as kind_of
from diagnosis.verdict import Amount
from experiments.diagnosis_report.numbers import amount_text
from experiments.diagnosis_report.place_words import at_words, place_words, sentence

NOTHING = "-"
"""Cell of the table of sizes for an effect that cannot be there or cannot be told."""

WORTH = 0.9
"""A motion is said to help an effect whose smallest size it shrinks below this share;
which ones are named is a matter of words, and nothing depends on it."""

MOST_NAMED = 3
"""Most effects that are named as examples of what a motion helps."""

CAREFUL = (
    "The motions keep the model's limits of position, speed and torque. What the robot "
    "may hit, its own links included, the model does not know: play them slowly first."
)

RECORDINGS = (
    "recording", "length", "rows a second", "jitter", "gaps", "joints that move",
)  # fmt: skip
NOISE = ("channel", "noise", "the sim is off by (times the noise)")


def recording_rows(found: Check) -> list[tuple[str, ...]]:
    """Rows of the table `RECORDINGS`."""
    rows: list[tuple[str, ...]] = []
    for one in found.audited.traces:
        moving = sum(joint.moves for joint in one.joints)
        gaps = str(one.gaps)
        if one.gaps:
            gaps += f", up to {1e3 * one.longest_gap_s:.3g} ms"
        rows.append(
            (
                one.name,
                f"{one.duration_s:.3g} s",
                f"{one.rate_hz:.3g}",
                f"{round(1e3 * one.jitter_s, 3):.2g} ms",
                gaps,
                f"{moving} of {len(one.joints)}",
            )
        )
    return rows


def noise_rows(found: Check) -> list[tuple[str, str, str]]:
    """Rows of the table `NOISE`: noise floor and error of the sim by channel."""
    off = {name: f"{float(f'{value:.2g}'):g}" for name, value in found.off.items()}
    return [
        (name, _fine(amount), off.get(name, "-"))
        for name, amount in found.noise.items()
    ]


def _fine(amount: Amount) -> str:
    if amount.unit in ("rad", "m") and amount.value < 0.1:
        return f"{1e3 * amount.value:.2g} m{amount.unit}"
    return amount_text(amount)


def verdict_sentence(found: Check) -> str:
    """Whether the recordings can be used, and how far."""
    if not found.usable:
        return "These recordings cannot be diagnosed: see what is wrong with them."
    told = sum(one.told is not None for one in found.sizes)
    limits = len(found.audited.limits)
    return (
        f"These recordings can be diagnosed. Of {len(found.sizes)} effects at their "
        f"places they would tell {told}, from the sizes below on"
        + (f"; {limits} findings limit what follows from them." if limits else ".")
    )


def size_tables(found: Check) -> list[tuple[tuple[str, ...], list[tuple[str, ...]]]]:
    """Tables (columns, rows) of the smallest sizes: effects over joints, then others.

    Rows are effects, columns are places.
    """
    tables = []
    for kind in ("joint", "body", ""):
        own = [one for one in found.sizes if _place_kind(one) == kind]
        places = list(dict.fromkeys(one.place for one in own))
        names = list(dict.fromkeys(one.name for one in own))
        known = {one.key: one for one in own}
        rows = []
        for name in names:
            label = kind_of(name).words.label
            cells = [_cell(known.get(f"{name}@{place}")) for place in places]
            rows.append((label, *cells))
        if rows:
            tables.append(((f"effect \\ {kind or 'place'}", *places), rows))
    return tables


def _place_kind(size: Size) -> str:
    kind = kind_of(size.name).place_kind
    return kind if kind in ("joint", "body") else ""


def _cell(size: Size | None) -> str:
    """A size as text; with "< " where the effect is the larger the smaller it is."""
    if size is None or size.told is None:
        return NOTHING
    return ("< " if size.below else "") + amount_text(size.told)


def lost_sentences(found: Check) -> list[str]:
    """Sentences on what the recordings cannot show or tell apart."""
    said = []
    for pair in found.alike:
        one, other = (at_words(_placed(key)) for key in (pair.one, pair.other))
        why = pair.why or "they look alike in these motions"
        said.append(f"{one} and {other} cannot be told apart: {why}")
    blind: dict[str, list[str]] = {}
    for size in found.sizes:
        if size.seen is None:
            place = place_words(size.place, kind_of(size.name).place_kind)
            blind.setdefault(place, []).append(kind_of(size.name).words.label)
    for place, labels in blind.items():
        said.append(f"no possible size would show at {place}: {', '.join(labels)}")
    return [sentence(one) for one in said]


def _placed(key: str) -> PlacedEffect:
    name, _, place = key.partition("@")
    return PlacedEffect(name, place)


def file_of(proposed: Proposed) -> str:
    """Name of the file with a motion's commands."""
    return f"{proposed.planned.motion.name}.csv"


def helped(found: Check, proposed: Proposed) -> list[tuple[Size, Amount]]:
    """Effects that a motion makes smaller to tell, those first that it helps most."""
    shares = []
    for size in found.sizes:
        then = proposed.sizes.get(size.key)
        if then is None or kind_of(size.name).threshold:
            continue
        if size.told is None:
            shares.append((0.0, size, then))
            continue
        now, later = size.told.value, then.value
        share = now / later if size.below else later / now
        if share < WORTH:
            shares.append((share, size, then))
    shares.sort(key=lambda one: one[0])
    return [(size, then) for _, size, then in shares]


def proposed_lines(found: Check) -> list[str]:
    """A line on each motion to record next, the most useful first."""
    said = []
    for one in found.proposed:
        motion, effects = one.planned.motion, helped(found, one)
        text = f"{file_of(one)}: {motion.words}, {motion.duration_s:g} s"
        if effects:
            some = [_change(size, then) for size, then in effects[:MOST_NAMED]]
            more = len(effects) - len(some)
            text += f"; {'; '.join(some)}" + (f"; {more} more" if more else "")
        else:
            text += "; it would hardly show anything that these recordings do not"
        said.append(f"{text}.")
    return said


def _change(size: Size, then: Amount) -> str:
    now = "not told" if size.told is None else amount_text(size.told)
    return f"{at_words(size.placed)} from {now} to {amount_text(then)}"


def finding_lines(found: Check) -> list[tuple[str, str]]:
    """Severity and text of each finding, the worst first, then limits."""
    order = ("refuse", "limit", "note")
    every = sorted(found.audited.findings, key=lambda one: order.index(one.severity))
    lines = [(str(one.severity), one.text) for one in every]
    return [*lines, *(("limit", text) for text in found.limits)]


def without_empty(
    columns: Sequence[str], rows: Sequence[Sequence[str]]
) -> tuple[list[str], list[list[str]]]:
    """A table without rows and columns in which nothing is told."""
    kept = [row for row in rows if any(cell != NOTHING for cell in row[1:])]
    some = [
        i
        for i in range(len(columns))
        if i == 0 or any(row[i] != NOTHING for row in kept)
    ]
    return [columns[i] for i in some], [[row[i] for i in some] for row in kept]
