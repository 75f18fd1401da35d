"""Commands that deal with a bus, each in a module that is loaded when somebody gives it.

A module has `add_arguments(parser)` and `run(options)`, which returns the exit status.
"""
