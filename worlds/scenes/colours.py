"""Colours of robots, ground and curves: red, green, blue from 0 to 255."""

Colour = tuple[int, int, int]

SHELL: Colour = (236, 236, 240)
DARK: Colour = (58, 62, 72)
SKY: Colour = (246, 248, 251)
GRASS: tuple[Colour, Colour] = ((88, 122, 82), (76, 108, 72))
FORCE: Colour = (255, 214, 0)
MASS: Colour = (150, 96, 220)
ZMP: Colour = (228, 40, 130)
SUPPORT_POLYGON: Colour = (40, 200, 235)
FALL: Colour = (226, 40, 40)
SIDES: dict[str, Colour] = {"left": (76, 155, 232), "right": (232, 146, 76)}
NEITHER_SIDE: Colour = (138, 143, 152)
AXES: tuple[Colour, ...] = ((235, 87, 87), (66, 186, 120), (76, 140, 245))
_ACCENTS: tuple[Colour, ...] = (
    (38, 110, 214),
    (226, 104, 32),
    (38, 150, 92),
    (142, 80, 190),
)


def accent(scene: int) -> Colour:
    """Colour that marks the robot of scene number `scene`, counted from 0."""
    return _ACCENTS[scene % len(_ACCENTS)]


def pale(colour: Colour) -> Colour:
    """Mix a colour with twice as much white, for example for a command's curve."""
    red, green, blue = ((part + 2 * 255) // 3 for part in colour)
    return red, green, blue
