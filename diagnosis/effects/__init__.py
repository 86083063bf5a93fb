"""Effects: kinds of physics that a sim may lack. `library` lists those built in.

An effect's class states all that others ask of it, so that a new effect is one file
here, one line in `library`, and its twin in `worlds.hidden.effects`. Effects of your
own need neither: see `also_known`.
"""

from diagnosis.effects.bases import (
    BodyEffect,
    JointEffect,
    JointNumber,
    ServoEffect,
    ServoNumber,
    TorqueEffect,
)
from diagnosis.effects.effect import Effect
from diagnosis.effects.library import all_effects, also_known, effect, grown_from
from diagnosis.effects.parts import (
    EffectWords,
    JointMotion,
    Parameter,
    PlacedEffect,
)
from diagnosis.effects.variants import Push, Variants

__all__ = [
    "BodyEffect",
    "Effect",
    "EffectWords",
    "JointEffect",
    "JointMotion",
    "JointNumber",
    "Parameter",
    "PlacedEffect",
    "Push",
    "ServoEffect",
    "ServoNumber",
    "TorqueEffect",
    "Variants",
    "all_effects",
    "also_known",
    "effect",
    "grown_from",
]
