"""Which effects, alone or together, explain the residuals."""
