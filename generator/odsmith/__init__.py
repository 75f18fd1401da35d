"""odsmith: one YAML model of a CANopen device, compiled into everything that is derived from it."""
