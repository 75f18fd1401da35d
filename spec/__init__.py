"""The spec library: standards, device families and devices as YAML. Package data of the generator."""
