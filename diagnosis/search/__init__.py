"""The search for missing physics (effects) that explains a sim's errors.

`screening` estimates what effects would explain, `candidates` proposes models,
`fitting` fits them, `judging` decides which to believe, `search` adds effects, `accept`
tests the result. `few_or_many` goes on in `many` where many joints are off (`spread`).
`reference` learns from recordings of the healthy robot.
"""
