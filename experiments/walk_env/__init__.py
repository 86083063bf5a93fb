"""A walk as an environment of Gymnasium."""
