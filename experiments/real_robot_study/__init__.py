"""Study of `groundwalk real-robots`: diagnoses compared with published values."""
