"""The search for missing physics (effects) that explains a sim's errors.

`screening` estimates what effects would explain, `candidates` proposes models,
`fitting` fits them, `judging` decides which to believe, `search` adds effects, `accept`
tests the result. `few_or_many` goes on with `everywhere` where many joints are off:
`each_joint` chooses effects at once (`stepwise`), `shared_first` adds kinds of them.
`reference` learns from recordings of the healthy robot.
"""
