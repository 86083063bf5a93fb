"""Answers to concealed cases held against their truths."""
