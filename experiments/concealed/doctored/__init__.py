"""Cases made of real recordings whose labels or models are made wrong on purpose."""
