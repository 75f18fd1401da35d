"""The C runtime: sources, ports and guide. Package data of the generator, which exports them."""
