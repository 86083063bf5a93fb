"""The plant: the nominal robot model with servos, from a name, an MJCF or a URDF."""
