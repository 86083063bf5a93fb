"""Models that learn what an action does, and which action has a wanted effect.

Forward models predict next states, inverse models actions.
"""
