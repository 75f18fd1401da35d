"""The templates of the built-in backends. Package data of the generator."""
