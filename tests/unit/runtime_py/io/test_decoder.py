"""Frames in words: one of each kind, and what the words depend on."""

from __future__ import annotations

from types import ModuleType

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.unit.runtime_py.io.conftest import read, write

from odsmith_runtime.device import Frame
from odsmith_runtime.io import VirtualDevice
from odsmith_runtime.io.decoder import Decoder, Message
from odsmith_runtime.io.log import EXTENDED, parse_line


@pytest.fixture
def decoder(package: ModuleType) -> Decoder:
    return Decoder([package])


def decode(decoder: Decoder, line: str) -> Message:
    logged = parse_line(line)
    assert logged is not None
    return decoder.decode(logged.frame)


@pytest.mark.parametrize(
    ("line", "service", "node", "text"),
    [
        ("000#0105", "NMT", 5, "Start remote node"),
        ("000#8000", "NMT", None, "Enter pre-operational, all nodes"),
        ("000#7701", "NMT", 1, "unknown command 77h"),
        ("000#01", "NMT", None, "1 octets, which is no command"),
        ("080#", "SYNC", None, ""),
        ("080#07", "SYNC", None, "counter 7"),
        ("100#0011", "TIME", None, "00 11"),
        ("705#00", "boot-up", 5, "it is there, and pre-operational"),
        ("705#05", "heartbeat", 5, "Operational"),
        ("705#FF", "heartbeat", 5, "Pre-operational"),
        ("705#33", "heartbeat", 5, "unknown state 33h"),
        ("705#R1", "guarding", 5, "request"),
        ("085#1043090203000000", "EMCY", 5,
         "4310h Overtemperature error of axis 3 (error register: generic, temperature)"),
        ("085#3412000000000000", "EMCY", 5, "1234h, which the model does not have: 00 00 00 00 00"),
        ("085#00", "EMCY", 5, "1 octets instead of 8"),
        ("605#4081600000000000", "SDO", 5, "read profile_velocity of axis 0 (6081h)"),
        ("585#4381600050C30000", "SDO", 5, "profile_velocity of axis 0 (6081h) is 50000 pps"),
        ("605#2F60680008000000", "SDO", 5,
         "write modes_of_operation of axis 1 (6860h) = 8 (cyclic_synchronous_position)"),
        ("605#2310100173617665", "SDO", 5, "write store_parameters.all (1010h:01) = save, the signature 65766173h"),
        ("585#8081600031000906", "SDO", 5, "refused: profile_velocity of axis 0 (6081h): Value too high (06090031h)"),
        ("585#8034120000000206", "SDO", 5, "refused: 1234h:00 (not in the model): Object does not exist (06020000h)"),
        ("605#8081600000000405", "SDO", 5, "the client gives up: profile_velocity of axis 0 (6081h): "
         "SDO protocol timed out (05040000h)"),
        ("605#A181600000000000", "SDO", 5, "block transfer"),
        ("605#40", "SDO", 5, "request of 1 octets, which a node ignores"),
        ("205#0F00", "RPDO 1", 5,
         "controlword of axis 0 (6040h) = 000Fh Switch on and enable operation, Enable operation"),
        ("185#3702", "TPDO 1", 5, "statusword of axis 0 (6041h) = 0237h Operation enabled; voltage_enabled, remote"),
        ("185#37", "TPDO 1", 5, "1 octets, which are too few for 16 bits"),
        ("765#04", "heartbeat", 101, "Stopped"),
        ("680#00", "unknown", None, "nobody is known to send or to want 680h"),
        ("00000585#00", "29 bit", None, "no frame of CANopen"),
    ],
)  # fmt: skip
def test_words(decoder: Decoder, line: str, service: str, node: int | None, text: str) -> None:
    message = decode(decoder, line)
    assert (message.service, message.node, message.text) == (service, node, text)


def test_an_emergency_says_what_to_do(decoder: Decoder) -> None:
    message = decode(decoder, "081#1043090200000000")
    assert [line.partition(":")[0] for line in message.more] == ["cause", "remedy"]
    assert message.facts["axis"] == 0


def test_an_abort_says_what_would_be_allowed(decoder: Decoder) -> None:
    message = decode(decoder, "581#8060600030000906")
    assert message.more[-1].startswith("allowed: ")
    assert "profile_position" in message.more[-1]


def test_words_depend_on_the_mode(decoder: Decoder) -> None:
    word = "601#2B4060001F000000"
    assert "new_set_point" not in decode(decoder, word).text
    decode(decoder, "601#4061600000000000")
    decode(decoder, "581#4F61600001000000")
    assert decode(decoder, word).text.endswith("; new_set_point")


def test_commands_depend_on_the_state(decoder: Decoder) -> None:
    decode(decoder, "181#3302")  # switched on
    assert decode(decoder, "201#0F00").text.endswith("000Fh Enable operation")


def test_units_depend_on_their_object(decoder: Decoder) -> None:
    speed = "581#4381600050C30000"
    assert decode(decoder, speed).text.endswith("50000 pps")
    decode(decoder, "601#2F8C200000000000")
    decode(decoder, "581#608C200000000000")
    assert decode(decoder, speed).text.endswith("50000 int. velocity")


def test_a_write_counts_when_it_is_confirmed(decoder: Decoder) -> None:
    decode(decoder, "601#2F8C200000000000")
    decode(decoder, "581#808C200022000008")
    assert decode(decoder, "581#4381600050C30000").text.endswith("50000 pps")


MAPPING = [
    "601#23001801810100C0",  # TPDO 1 off
    "601#2F001A0000000000",
    "601#23001A0120006460",  # the position
    "601#23001A0210004160",  # and the statusword
    "601#2F001A0002000000",
    "601#2300180181010040",
]


def follow(decoder: Decoder, package: ModuleType, lines: list[str]) -> None:
    """Show what a device answers, too."""
    device = VirtualDevice(package, engine="python")
    for line in lines:
        logged = parse_line(line)
        assert logged is not None
        decoder.decode(logged.frame)
        for answer in device.exchange(logged.frame):
            assert "refused" not in decoder.decode(answer).text


def test_the_mapping_is_followed(decoder: Decoder, package: ModuleType) -> None:
    follow(decoder, package, MAPPING)
    text = decode(decoder, "181#FFFFFFFF3702").text
    assert text.startswith(
        "position_actual_value of axis 0 (6064h) = -1 microstep, statusword of axis 0 (6041h) = 0237h"
    )
    decode(decoder, "000#8201")
    decode(decoder, "701#00")
    assert decode(decoder, "181#3702").text.startswith("statusword")


def test_a_can_id_can_be_moved(decoder: Decoder, package: ModuleType) -> None:
    follow(decoder, package, ["601#23001801810100C0", "601#2300180185010040"])
    message = decode(decoder, "185#3702")
    assert (message.service, message.node) == ("TPDO 1", 1)
    decode(decoder, "705#00")
    message = decode(decoder, "185#3702")
    assert (message.service, message.node) == ("PDO", None)  # it is that of node 5, too, as delivered
    assert "node 1 TPDO 1: statusword" in message.text


def test_a_reset_of_the_communication_leaves_the_rest(decoder: Decoder) -> None:
    decode(decoder, "581#4F8C200000000000")
    decode(decoder, "000#8200")
    decode(decoder, "701#00")
    assert decode(decoder, "581#4381600050C30000").text.endswith("int. velocity")
    decode(decoder, "000#8100")
    decode(decoder, "701#00")
    assert decode(decoder, "581#4381600050C30000").text.endswith("pps")


def test_segments(decoder: Decoder, device: VirtualDevice) -> None:
    request, texts = read(0x1008), list[str]()
    for _ in range(3):
        decoder.decode(request)
        (answer,) = device.exchange(request)
        texts.append(decoder.decode(answer).text)
        request = Frame(0x601, bytes([0x60 if len(texts) == 1 else 0x70, *bytes(7)]))
    assert texts == [
        "device_name (1008h) comes in segments",
        "device_name (1008h): segment, 7 octets so far",
        "device_name (1008h) is 'TMCM-6212'",
    ]


def test_a_write_in_segments(decoder: Decoder) -> None:
    texts = [
        decode(decoder, line).text
        for line in ("601#2117100002000000", "581#6017100000000000", "601#0B64000000000000", "581#2000000000000000")
    ]
    assert texts == [
        "write producer_heartbeat_time (1017h) in segments, 2 octets",
        "ready to take producer_heartbeat_time (1017h)",
        "write producer_heartbeat_time (1017h): last segment, 100 ms",
        "producer_heartbeat_time (1017h) is written",
    ]


def test_the_model_is_told_by_the_identity(package: ModuleType, other_package: ModuleType) -> None:
    decoder = Decoder([other_package, package])
    assert decoder.node(1).package is other_package
    decode(decoder, "581#4318100244180000")
    assert decoder.node(1).package is package
    assert decoder.node(2).package is other_package


def test_the_model_is_told_by_its_objects(package: ModuleType, other_package: ModuleType) -> None:
    decoder = Decoder([other_package, package])
    assert "not in the model" in decode(decoder, "602#40FFFF0000000000").text
    decode(decoder, "601#4040880000000000")  # the controlword of axis 5
    assert decoder.node(1).package is package


@given(st.integers(0, 0x7FF) | st.just(0x601 | EXTENDED), st.binary(max_size=8), st.booleans())
def test_any_frame_has_words(package: ModuleType, identifier: int, data: bytes, remote: bool) -> None:
    frame = Frame(identifier, remote=True, length=1) if remote else Frame(identifier, data)
    assert Decoder([package]).decode(frame).service


@given(st.lists(st.tuples(st.sampled_from([0x601, 0x581]), st.binary(min_size=8, max_size=8)), max_size=12))
def test_any_dialogue_has_words(package: ModuleType, dialogue: list[tuple[int, bytes]]) -> None:
    decoder = Decoder([package])
    assert all(decoder.decode(Frame(*frame)).text for frame in dialogue)


def test_requests_of_tests_are_what_they_say(decoder: Decoder) -> None:
    assert decoder.decode(write(0x607A, -5, 4)).text == "write target_position of axis 0 (607Ah) = -5 microstep"
