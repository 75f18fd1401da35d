"""The non-volatile memory of virtual devices in a file, so that what a program stores is there tomorrow.

The file is JSON: for each node, by the node-ID that it was started with, the image of its memory and a checksum. It is
replaced in one step, so it is the old one or the new one at any loss of power. A file that is not understood is never
written to.
"""

from __future__ import annotations

import json
import os
import tempfile
import zlib
from pathlib import Path

FORMAT = "odsmith virtual device 1"


class StateError(Exception):
    """A state file cannot be used; `hint` says what to do."""

    def __init__(self, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.hint = hint


class StateFile:
    """The file at `path`, of devices of one package. Whether it can be written is found out now, not when it matters.

    Raises StateError for one that cannot be read or written, is damaged or of another device.
    """

    def __init__(self, path: Path, device: str) -> None:
        self.path = path
        self._device = device
        self._images: dict[str, bytes] = {}
        try:
            self._images = self._parse(path.read_bytes())
        except FileNotFoundError:
            pass
        except OSError as error:
            raise StateError(f"{path} cannot be read: {error.strerror}", "name another file") from None
        self._try_folder()

    def image(self, node: int) -> bytes | None:
        """The memory of a node; None for one that was never stored."""
        return self._images.get(str(node))

    def save(self, node: int, image: bytes) -> None:
        """Keep the memory of a node, if it is not the one that the file has. Raises OSError."""
        if self._images.get(str(node)) == image:
            return
        images = self._images | {str(node): image}
        nodes = {name: {"crc32": zlib.crc32(images[name]), "image": images[name].hex()} for name in sorted(images)}
        content = {"format": FORMAT, "device": self._device, "nodes": nodes}
        _replace(self.path, (json.dumps(content, indent=1) + "\n").encode())
        self._images = images

    def _try_folder(self) -> None:
        """Each saving makes a new file beside the old one, so see whether that works."""
        folder = self.path.resolve().parent
        try:
            with tempfile.TemporaryFile(dir=folder):
                pass
        except OSError as error:
            raise StateError(
                f"{self.path} cannot be written: {folder}: {error.strerror}",
                "make this folder, or name a file in another one" if not folder.exists() else "name another folder",
            ) from None

    def _parse(self, text: bytes) -> dict[str, bytes]:
        try:
            content = json.loads(text)
            if content["format"] != FORMAT:
                raise ValueError
            device = str(content["device"])
            images = {}
            for name, node in content["nodes"].items():
                images[str(name)] = bytes.fromhex(node["image"])
                if zlib.crc32(images[str(name)]) != node["crc32"]:
                    raise ValueError
        except (ValueError, LookupError, TypeError, AttributeError, RecursionError):
            raise StateError(
                f"{self.path} is damaged or no state of a virtual device", "name another file, or move this one away"
            ) from None
        if device != self._device:
            raise StateError(
                f"{self.path} is the state of a {device}, not of a {self._device}", "name another file for this device"
            )
        return images


def _replace(path: Path, content: bytes) -> None:
    path = path.resolve()  # a link stays a link
    handle, temporary = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        Path(temporary).chmod(path.stat().st_mode & 0o777 if path.exists() else 0o644)
        Path(temporary).replace(path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise
