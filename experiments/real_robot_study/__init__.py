"""Study of `groundwalk real-robots`: diagnoses of real robots against known values."""
