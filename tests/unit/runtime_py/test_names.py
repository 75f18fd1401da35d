"""Entries as attributes."""

from __future__ import annotations

from typing import Any

import pytest

from odsmith_runtime import ObjectDictionary
from odsmith_runtime.names import Names


def test_attributes_are_the_entries(dictionary: ObjectDictionary) -> None:
    first, second = dictionary.axes
    assert first.controlword is dictionary[0x6040][0]
    assert second.controlword is dictionary[0x6840][0]
    assert second.homing_speeds.fast is dictionary[0x6899][1]
    assert dictionary.device.device_name is dictionary[0x1008][0]


def test_records_of_pdos_go_by_number(dictionary: ObjectDictionary) -> None:
    family = dictionary.axes[1].rpdo_communication
    assert list(family) == [1, 2]
    assert family[2].cob_id is dictionary[0x1441][1]


def test_made_once(dictionary: ObjectDictionary) -> None:
    assert dictionary.axes is dictionary.axes
    assert dictionary.axes[0].homing_speeds is dictionary.axes[0].homing_speeds


def test_a_name_cannot_be_replaced(dictionary: ObjectDictionary) -> None:
    with pytest.raises(AttributeError, match="'controlword' names an entry"):
        dictionary.axes[0].controlword = 15
    with pytest.raises(AttributeError, match="'controlwrod' names an entry"):
        dictionary.axes[0].controlwrod = 15


def test_a_wrong_name(dictionary: ObjectDictionary) -> None:
    with pytest.raises(AttributeError, match="controlwrod"):
        _ = dictionary.axes[0].controlwrod


def test_the_class_shows_its_declarations(dictionary: ObjectDictionary) -> None:
    names = type(dictionary.axes[0])
    assert names.controlword.base_index == 0x6040
    assert names.homing_speeds.base_index == 0x6099
    assert names.rpdo_communication.count == 2


def test_another_holder_puts_its_own_things_behind_the_names(dictionary: ObjectDictionary) -> None:
    class Remote:
        def __init__(self, entry: Any) -> None:
            self.entry = entry

    class Live(Names):
        def _item(self, base_index: int, sub: int) -> Any:
            return Remote(super()._item(base_index, sub))

        def _group(self, names: type[Any], base_index: int, number: int = 1) -> Any:
            live = type(names.__name__, (Live, names), {})
            return live(self._dictionary, self._axis, base_index, number)

    class Axis(Live, type(dictionary.axes[0])):  # type: ignore[misc]
        pass

    axis = Axis(dictionary, 1)
    assert isinstance(axis.controlword, Remote)
    assert axis.controlword.entry is dictionary[0x6840][0]
    assert axis.homing_speeds.fast.entry is dictionary[0x6899][1]
    assert axis.rpdo_communication[2].cob_id.entry is dictionary[0x1441][1]
