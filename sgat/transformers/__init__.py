"""Action transformers: actions of the sim that do what the real world would."""
