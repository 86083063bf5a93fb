"""Small mismatch that every robot model has (the nuisance), and how it is fitted.

`usual_errors` says how large it usually is, `nuisance.Nuisance` holds likely values,
and `nuisance_fit.NuisanceFit` finds them beside what is looked for.
"""
