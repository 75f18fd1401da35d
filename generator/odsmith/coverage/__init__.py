"""What a model covers of the manual that it comes from.

`account` sets the elements of a model, by their sources, against the sections and tables that the manual has; it needs
nothing but the spec. `manual_text` reads the text of a manual, `compare` holds its tables cell by cell against the
model, `report` says it all to people and machines, and `command` does one after the other.
"""
