"""The studies and the command line: the only place where rooms are combined."""
