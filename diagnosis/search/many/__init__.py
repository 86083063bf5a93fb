"""The search for effects at many joints, where few effects do not suffice.

`everywhere` decides: `each_joint` chooses effects at once by linear estimates
(`stepwise`), `shared_first` adds kinds of effects (`kinds`) that joints share. `fits`
fits models, `ebic` compares them, `pruning` takes out what they do not need, and
`known_changes` spares replays.
"""
