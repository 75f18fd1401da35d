"""What an entry knows, and which values it takes."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from odsmith_runtime import (
    ObjectDictionary,
    OutOfRangeError,
    ReadOnlyError,
    RefusedError,
    WrongLengthError,
    WrongSignatureError,
    WrongTypeError,
    codec,
)
from odsmith_runtime.entries import Entry, Object


def test_where_it_is(dictionary: ObjectDictionary) -> None:
    fast = dictionary[0x6899]["fast"]
    assert (fast.index, fast.sub, fast.axis, fast.parent) == (0x6899, 1, 1, dictionary[0x6899])
    assert (fast.full_name, fast.label) == ("homing_speeds.fast", "homing_speeds.fast of axis 1 (6899h:01)")
    assert dictionary["device_name"][0].label == "device_name (1008h)"


def test_what_it_is(dictionary: ObjectDictionary) -> None:
    fast = dictionary[0x6099]["fast"]
    assert (fast.low, fast.high, fast.bit_length) == (-5, 9, 32)
    assert fast.unit is not None
    assert fast.unit.symbol == "pps"
    assert dictionary[0x6040][0].low == 0
    assert dictionary[0x6040][0].high == 0xFFFF
    assert dictionary[0x2702][0].high is None
    assert dictionary[0x1008][0].bit_length == 40
    assert dictionary[0x1008][0].unit is None


@pytest.mark.parametrize(
    ("index", "readable", "writable", "receivable", "transmittable", "constant"),
    [
        (0x6040, True, True, True, False, False),
        (0x6041, True, False, False, True, False),
        (0x2701, False, True, False, False, False),
        (0x6502, True, False, False, False, True),
    ],
)
def test_access(
    dictionary: ObjectDictionary,
    index: int,
    readable: bool,
    writable: bool,
    receivable: bool,
    transmittable: bool,
    constant: bool,
) -> None:
    entry = dictionary[index][0]
    assert (entry.readable, entry.writable, entry.constant) == (readable, writable, constant)
    assert (entry.receivable, entry.transmittable) == (receivable, transmittable)


def test_both_directions(dictionary: ObjectDictionary) -> None:
    assert dictionary[0x6099][1].receivable
    assert dictionary[0x6099][1].transmittable


def test_defaults(dictionary: ObjectDictionary) -> None:
    assert dictionary["cob_id_emcy"][0].default() == 0x81
    assert dictionary["cob_id_emcy"][0].default(node_id=127) == 0xFF
    assert dictionary["device_name"][0].default() == "toy"
    assert dictionary["statusword"][0].default() is None


def test_initial_values(dictionary: ObjectDictionary) -> None:
    assert dictionary["cob_id_emcy"][0].initial(2) == 0x82
    assert dictionary["statusword"][0].initial() == 0
    assert dictionary["os_command"][0].initial() == b""
    assert dictionary["fraction"][0].initial() == 0.0


def test_named_values(dictionary: ObjectDictionary) -> None:
    entry = dictionary["chopper_mode"][0]
    assert entry.values is not None
    assert entry.decode(b"\x01") is entry.values.CONSTANT_OFF_TIME  # type: ignore[attr-defined]
    assert entry.decode(b"\x07") == 7
    assert type(entry.decode(b"\x07")) is int
    assert entry.default() is entry.values.SPREAD_CYCLE  # type: ignore[attr-defined]


def test_bits(dictionary: ObjectDictionary) -> None:
    entry = dictionary["controlword"][0]
    assert entry.bits is not None
    value = entry.decode(b"\x51\x80")
    assert isinstance(value, entry.bits)
    assert value == 0x8051
    assert entry.bits.SWITCH_ON in value  # type: ignore[attr-defined]
    assert entry.encode(value) == b"\x51\x80"


def test_a_value_in_range_passes(dictionary: ObjectDictionary) -> None:
    for value in (-5, 0, 9):
        dictionary[0x6099]["fast"].check(value)
    for value in (0, 2, 15):
        dictionary[0x6099]["slow"].check(value)
    dictionary["device_name"][0].check("abcde")
    dictionary["os_command"][0].check(b"abc")
    dictionary["fraction"][0].check(0.5)
    dictionary["command"][0].check(0x65766173)


@pytest.mark.parametrize(
    ("name", "value", "error", "message"),
    [
        ("statusword", 0, ReadOnlyError, "statusword of axis 1 (6841h): cannot be written"),
        ("homing_speeds.fast", 10, OutOfRangeError, "homing_speeds.fast of axis 1 (6899h:01): 10 is not in -5..9 pps"),
        ("homing_speeds.slow", 1, OutOfRangeError, "homing_speeds.slow of axis 1 (6899h:02): 1 is not in 0, 2..15"),
        (
            "chopper_mode",
            3,
            OutOfRangeError,
            "chopper_mode of axis 1 (2293h): 3 is not in 0 (spread_cycle), 1 (constant_off_time), 5 (other)",
        ),
        (
            "controlword",
            0x10000,
            OutOfRangeError,
            "controlword of axis 1 (6840h): 65536 is not in 0..65535, which UNSIGNED16 can hold",
        ),
        ("controlword", "run", WrongTypeError, "controlword of axis 1 (6840h): 'run' is no integer"),
        ("controlword", 1.0, WrongTypeError, "controlword of axis 1 (6840h): 1.0 is no integer"),
    ],
)
def test_refusals_on_an_axis(
    dictionary: ObjectDictionary, name: str, value: object, error: type[RefusedError], message: str
) -> None:
    entry = dictionary.entry(name, axis=1)
    with pytest.raises(error) as caught:
        entry.check(value)
    assert str(caught.value) == message
    assert (caught.value.entry, caught.value.axis, caught.value.value) == (entry, 1, value)
    assert message.endswith(caught.value.limit)


@pytest.mark.parametrize(
    ("name", "value", "error", "message"),
    [
        ("device_name", "abcdef", WrongLengthError, "device_name (1008h): 6 octets, 5 at most"),
        ("device_name", "é", OutOfRangeError, "device_name (1008h): 'é' is not ASCII"),
        ("os_command", b"abcd", WrongLengthError, "os_command (2700h): 4 octets, 3 at most"),
        ("command", 1, WrongSignatureError, "command (2701h): 1 is not the signature save (65766173h)"),
    ],
)
def test_refusals_of_the_device(
    dictionary: ObjectDictionary, name: str, value: object, error: type[RefusedError], message: str
) -> None:
    with pytest.raises(error) as caught:
        dictionary.entry(name).check(value)
    assert str(caught.value) == message
    assert caught.value.axis is None


def test_errors_are_values_or_types(dictionary: ObjectDictionary) -> None:
    with pytest.raises(ValueError, match="is not in"):
        dictionary[0x6099][1].check(99)
    with pytest.raises(TypeError, match="is no integer"):
        dictionary[0x6099][1].check("99")


def test_octets_of_a_wrong_number(dictionary: ObjectDictionary) -> None:
    with pytest.raises(WrongLengthError, match=r"controlword of axis 0 \(6040h\): 1 octets instead of 2"):
        dictionary["controlword"][0].decode(b"\x00")


@st.composite
def integer_entries(draw: st.DrawFn) -> Entry[int]:
    """An entry of an integer type with a set of at most four intervals."""
    data_type = draw(st.sampled_from(sorted(codec.INTEGERS)))
    low, high = codec.limits(data_type) or (0, 0)
    ends = sorted(draw(st.sets(st.integers(low, high), min_size=2, max_size=8)))
    intervals = tuple(zip(ends[::2], ends[1::2], strict=False))
    parent = Object(
        dictionary=ObjectDictionary("none", axis_count=0, areas=(), objects={}, entries={}, pdos={}, max_pdo_entries=0),
        index=0x2000,
        base_index=0x2000,
        name="x",
        title="X",
        parameter_name="X",
        object_type="VAR",
        axis=None,
        pdo="",
        number=0,
        entries=(),
    )
    return Entry(
        parent=parent,
        sub=0,
        name="x",
        title="X",
        parameter_name="X",
        type=data_type,
        access="rw",
        mapping="no",
        stated_default=None,
        allowed=intervals,
    )


@given(integer_entries(), st.data())
def test_check_takes_exactly_the_set(entry: Entry[int], data: st.DataObject) -> None:
    near = [edge + step for interval in entry.allowed for edge in interval for step in (-1, 0, 1)]
    value = data.draw(st.integers(-(2**65), 2**65) | st.sampled_from(near))
    allowed = any(value in range(low, high + 1) for low, high in entry.allowed)
    if allowed:
        entry.check(value)
        assert entry.decode(entry.encode(value)) == value
    else:
        with pytest.raises(OutOfRangeError):
            entry.check(value)
    assert entry.low == entry.allowed[0][0]
    assert entry.high == entry.allowed[-1][1]
