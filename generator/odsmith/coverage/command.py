"""What `odsmith coverage` does: from compiled specs to what there is to report."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from odsmith.compile import Compiled
from odsmith.coverage.account import account
from odsmith.coverage.compare import compare
from odsmith.coverage.manual_text import read_manual
from odsmith.coverage.report import Coverage
from odsmith.errors import UsageError
from odsmith.project import devices


def cover(compiled: Iterable[Compiled], text: Path | None, named: bool) -> tuple[list[Coverage], dict[str, str]]:
    """The coverage of each device whose manual the spec describes, and the texts that its findings are about.

    `text` is the file with the text of the manual, for one device. Raises UsageError where there is no manual to
    speak of: of any of the devices if they were `named`, else of all of them.
    """
    compiled = list(compiled)
    models = devices(compiled)
    known = [device for device in models if device.manual]
    if not known or (named and len(known) < len(models)):
        missing = next((device.identity.name for device in models if not device.manual), "these files")
        raise UsageError(f"the spec does not say what the manual of {missing} contains", "describe it in `manuals`")
    texts = {path: content for item in compiled for path, content in item.loaded.texts.items()}
    if text is None:
        return [Coverage(device, account(device, device.manual)) for device in known if device.manual], texts
    if len(known) > 1:
        raise UsageError("one manual is of one device", "name the device: odsmith coverage DEVICE --manual FILE")
    device, manual = known[0], known[0].manual
    assert manual
    printed = read_manual(text)
    texts[printed.path] = printed.text
    accounted = account(device, manual)
    return [Coverage(device, accounted, compare(device, accounted, printed))], texts
