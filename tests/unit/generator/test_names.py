"""Identifiers of the target languages."""

from __future__ import annotations

from odsmith import names


def test_spellings() -> None:
    assert names.constant("tmcm3230", "switch_parameters", "") == "TMCM3230_SWITCH_PARAMETERS"
    assert names.class_name("modes_of_operation") == "ModesOfOperation"


def test_reserved_words() -> None:
    assert names.reserved_in_c("int")
    assert names.reserved_in_c("class")
    assert not names.reserved_in_c("interpolation")
    assert names.reserved_in_python("lambda")
    assert not names.reserved_in_python("match")
