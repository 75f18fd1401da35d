"""Both engines behind one face: what they are told, what they tell, and that they are the same."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.unit.runtime_py.io.conftest import ROOT, Make, number, read, write

from odsmith_runtime.device import Can, Frame, Input
from odsmith_runtime.io.c_engine import CONDITION_NUMBERS, CEngine
from odsmith_runtime.io.engine import Engine, EngineError, Sent, make_engine
from odsmith_runtime.io.python_engine import PythonEngine


def test_it_boots(make: Make) -> None:
    engine = make(5).engine
    assert (engine.node_id, engine.bit_rate, engine.nmt_code, engine.is_on) == (5, 1000, 127, True)
    assert number(make(5), 0x1018, 4) == 5  # the serial number is the node's


def test_frames_bear_their_instant(make: Make) -> None:
    device = make()
    device.exchange(write(0x1017, 10, 2))
    heard: list[tuple[int, Frame]] = []
    device.simulator.observers.append(lambda time, frame, origin: heard.append((time, frame)))
    device.run(0.03)
    assert heard == [(at, Frame(0x701, b"\x7f")) for at in (10_000, 20_000, 30_000)]
    assert device.engine.next() == 40_000


def test_time_does_not_wrap(make: Make) -> None:
    """A node sees 32 bits of the time, the engine all of them."""
    device = make()
    device.exchange(Frame(0, b"\x01\0"))  # in OPERATIONAL no LED blinks, so nothing happens for hours
    engine, begin = device.engine, 3 << 32
    engine.advance(begin)
    engine.take()
    engine.receive(begin, write(0x1017, 1000, 2))
    assert [time for time, _ in engine.take()] == [begin]
    assert engine.next() == begin + 1_000_000
    engine.advance(begin + 1_000_000)
    assert engine.take() == [Sent(begin + 1_000_000, Frame(0x701, b"\x05"))]


def test_many_frames_at_once_are_all_there(make: Make) -> None:
    engine = make().engine
    engine.receive(0, write(0x1017, 1, 2))
    engine.take()
    engine.advance(3_000_000)
    assert [sent.time for sent in engine.take()] == [1000 * n for n in range(1, 3001)]


def test_memory_outlives_power(make: Make) -> None:
    device = make()
    device.exchange(write(0x1017, 77, 2), write(0x1010, 0x65766173, 4, sub=1))
    assert device.engine.memory_writes > 0
    device.power_off()
    assert (device.run(0.1), device.exchange(read(0x1000))) == ([], [])
    assert not any((device.engine.outputs.run_led, device.engine.is_on))
    device.power_on()
    assert number(device, 0x1017) == 77
    copy = make()
    copy.power_off()
    copy.engine.load_memory(device.engine.memory)
    copy.power_on()
    assert number(copy, 0x1017) == 77
    with pytest.raises(ValueError, match="an image of 3 octets"):
        copy.engine.load_memory(b"abc")


def test_inputs_stay_over_a_loss_of_power(make: Make) -> None:
    device = make()
    device.input(Input.ADDRESS, 0, 9)
    device.digital_input(2, True)
    device.power_off()
    device.power_on()
    device.run(0.002)
    assert device.node_id == 9
    assert number(device, 0x3002) == 0x40000


def test_hardware(make: Make) -> None:
    device = make()
    device.set_hardware(3, "shaft", -500)
    assert device.engine.shaft(3) == -500
    with pytest.raises(ValueError, match="left"):
        device.set_hardware(0, "left", 2)
    with pytest.raises(ValueError, match="shaft"):
        device.set_hardware(0, "shaft", 1 << 40)
    with pytest.raises(KeyError):
        device.set_hardware(0, "colour", 1)


def test_faults_and_the_controller(make: Make) -> None:
    device = make()
    device.fault(2, "overtemperature")
    device.run(0.001)
    assert device.view().axes[2].state == "Fault"
    device.report_can(Can.BUS_OFF)
    assert device.exchange(read(0x1000)) == []
    device.report_can(Can.OK)
    assert device.exchange(read(0x1000)) != []


def test_a_motor_turns(make: Make) -> None:
    device = make()
    device.exchange(write(0x2005, 3, 4), write(0x6060, 3, 1), write(0x6083, 50_000, 4), write(0x60FF, 10_000, 4))
    for word in (6, 7, 15):
        device.exchange(write(0x6040, word, 2))
    device.run(1)
    axis = device.view().axes[0]
    assert (axis.state, axis.mode, axis.velocity) == ("Operation enabled", "pv", 10_000)
    assert axis.shaft == axis.position == pytest.approx(9000, abs=20)
    assert (device.engine.outputs.power, device.engine.outputs.current[0] > 0) == ([1, 0, 0, 0, 0, 0], True)


def frames_of(identifiers: list[int]) -> st.SearchStrategy[Frame]:
    return st.tuples(st.sampled_from(identifiers), st.binary(max_size=8)).map(lambda pair: Frame(*pair))


events = st.one_of(
    st.tuples(st.just("run"), st.integers(0, 5000)),
    st.tuples(st.just("frame"), frames_of([0, 0x80, 0x201, 0x601, 0x702])),
    st.tuples(
        st.just("frame"),
        st.builds(
            write,
            st.sampled_from([0x6040, 0x6060, 0x607A, 0x60FF, 0x6083, 0x6098, 0x1017, 0x1015]),
            st.integers(0, 31) | st.integers(-100_000, 100_000),
            st.sampled_from([1, 2, 4]),
        ),
    ),
    st.tuples(st.just("frame"), st.just(Frame(0, b"\x01\0"))),
    st.tuples(st.just("fault"), st.sampled_from(["overtemperature", "undervoltage", "open_load_a"]), st.booleans()),
    st.tuples(st.just("hardware"), st.sampled_from(["left", "right", "blocked"]), st.integers(0, 1)),
)


@pytest.mark.slow
@settings(max_examples=60)
@given(st.lists(events, max_size=40))
def test_both_do_the_same(package: ModuleType, c_library: Path, script: list[tuple[object, ...]]) -> None:
    engines: list[Engine] = [PythonEngine(package, node_id=1), CEngine(package, c_library, node_id=1)]
    told = [list(_play(engine, script)) for engine in engines]
    assert told[0] == told[1]


def _play(engine: Engine, script: list[tuple[object, ...]]) -> list[object]:
    now = 5
    engine.power_on(now)
    told: list[object] = []
    for kind, *arguments in script:
        match kind, arguments:
            case "run", [int(step)]:
                now += step
                engine.advance(now)
            case "frame", [Frame() as frame]:
                engine.receive(now, frame)
            case "fault", [str(condition), bool(holds)]:
                engine.fault(now, 1, condition, holds)
            case "hardware", [str(name), int(value)]:
                engine.set_hardware(now, 0, name, value)
        outputs = engine.outputs
        told += [engine.take(), engine.next(), engine.shaft(0), outputs.run_led, outputs.power, outputs.current]
    return told


# ---- which engine ----------------------------------------------------------------------------------------------------


def test_the_conditions_have_the_numbers_of_c() -> None:
    header = (ROOT / "generated/cia/c/ods/vocabulary.h").read_text()
    listed = header[: header.index("ODS_CONDITIONS")].rpartition("typedef enum")[2]
    names = [
        line.split(",")[0].strip().removeprefix("ODS_CONDITION_").lower()
        for line in listed.splitlines()
        if "ODS_" in line
    ]
    assert list(CONDITION_NUMBERS) == [name for name in names if name]


def test_python_where_there_is_no_library(package: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert make_engine(package, 1).name == "python"
    with pytest.raises(EngineError, match="no C library of tmcm6212") as raised:
        make_engine(package, 1, choice="c")
    assert raised.value.hint == "build it: odsmith engine tmcm6212"
    with pytest.raises(EngineError, match="no engine `rust`"):
        make_engine(package, 1, choice="rust")


@pytest.mark.slow
def test_c_where_there_is_one(package: ModuleType, c_library: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(c_library.parents[3]))
    assert make_engine(package, 1).name == "c"


def test_a_file_that_is_no_library(package: ModuleType, tmp_path: Path) -> None:
    path = tmp_path / "broken.so"
    path.write_bytes(b"not a library")
    with pytest.raises(EngineError, match="cannot be used"):
        CEngine(package, path, node_id=1)
