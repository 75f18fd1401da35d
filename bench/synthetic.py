"""A made-up device with many axes, to see how a build grows."""

from __future__ import annotations

HEAD = """\
format: 1
include: [cia/301.yaml, cia/units.yaml, cia/runtime_device.yaml]
device:
  identifier: synthetic{axes}
  name: SYN-{axes}
  title: Synthetic device
  text: A device that exists only to be measured.
  version: 1.0.0
  vendor: Example Works
  vendor_id: 0x1
  product_code: {axes}
  revision_number: 1
  profile: 401
  bit_rates: [125, 500, 1000]
  eds: {{file: SYN-{axes}.eds, version: 1, revision: 0, description: Synthetic, created_by: odsmith,
        creation_date: 11-22-2026, creation_time: "09:00AM"}}
axes:
  count: {axes}
  areas:
    manufacturer: {{first: 0x2000, last: 0x203F, stride: 0x40}}
  device_wide:
    - {{first: 0x1000, last: 0x1FFF}}
storage_groups:
  all: {{text: Everything.}}
objects:
  - {{index: 0x1000, name: device_type, title: Device type, type: UNSIGNED32, access: ro, default: 401, text: Type.,
     source: {{cia301: "7.5.2.1"}}}}
  - {{index: 0x1001, name: error_register, title: Error register, type: UNSIGNED8, access: ro, role: error_register,
     text: Errors., source: {{cia301: "7.5.2.2"}}}}
  - index: 0x1018
    name: identity_object
    title: Identity object
    object_type: RECORD
    type: UNSIGNED32
    access: ro
    subs:
      "1": {{name: vendor_id, title: Vendor-ID, default: 1, text: Vendor.}}
    text: Identity.
    source: {{cia301: "7.5.2.19"}}
"""

OBJECT = """\
  - {{index: {index}, name: value_{number}, title: Value {number}, type: UNSIGNED16, access: rw, range: 0..{high},
     default: {number}, stored: all, effect: value, text: A value., source: {{inferred: for measuring}}}}
"""


def synthetic_spec(axes: int) -> str:
    """YAML of a device with 64 objects on each of its axes."""
    objects = (OBJECT.format(index=hex(0x2000 + n), number=n, high=1000 + n) for n in range(64))
    return HEAD.format(axes=axes) + "".join(objects)
