"""The search for effects that explain the residuals.

`signatures` and `screening` guess, `candidates` proposes models, `fitting` fits them,
`judging` decides which to believe, `search` grows them, `accept` tests the result, and
`all_joints` searches for effects that all joints lack. `reference` learns from
recordings of the healthy robot; `hooks` report progress and store results.
"""
