"""The Python runtime of devices that odsmith describes."""
