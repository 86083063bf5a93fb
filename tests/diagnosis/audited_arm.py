"""An arm whose recordings are good, and ways to spoil and to read them."""

import numpy as np

from diagnosis.audit.audit import audit
from diagnosis.plant.servo import Servo

HZ, SECONDS = 100, 20
NOISE, QUANTUM = 3e-4, 1.5e-3


def servo(kp=20.0):
    return Servo(np.full(3, kp), np.ones(3), np.full(3, 5.0), np.zeros(3))


def motions(time_s):
    """(T, 3) three motions that have little in common."""
    return np.stack(
        [
            0.4 * np.sin(2 * np.pi * 0.7 * time_s),
            0.3 * np.sin(2 * np.pi * 1.1 * time_s + 1) + 0.2,
            0.5 * np.sin(2 * np.pi * 0.3 * time_s + 2) - 0.1,
        ],
        axis=1,
    )


def changed(values, column, new):
    copy = values.copy()
    copy[:, column] = new
    return copy


def texts(traces, plant, severity):
    findings = audit(traces, plant).findings
    return [item.text for item in findings if item.severity == severity]


def one(texts, *words):
    """The only text that has all the words."""
    found = [text for text in texts if all(word in text for word in words)]
    assert len(found) == 1, texts
    return found[0]
