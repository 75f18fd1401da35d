"""What a template sees of each thing that is no object: words and links, ready to be laid out."""

from __future__ import annotations

from typing import NamedTuple

from odsmith.backends.docs.objects import BitRow
from odsmith.backends.docs.text import Rich


class PdoRow(NamedTuple):
    """The power-on parameters of one PDO on one axis. `id` is set for those of axis 0."""

    id: str
    number: str
    axis: int
    indices: str
    cob_id: str
    active: bool
    transmission: str
    inhibit_time: int
    event_timer: int
    mapped: Rich
    source: Rich


class PdoTable(NamedTuple):
    title: str
    rows: tuple[PdoRow, ...]


class StepView(NamedTuple):
    action: Rich
    text: Rich
    added: Rich


class RecipeView(NamedTuple):
    id: str
    title: str
    text: Rich
    steps: tuple[StepView, ...]
    source: Rich


class ModeObject(NamedTuple):
    address: Rich
    title: str
    access: str
    unit: str


class ModeView(NamedTuple):
    id: str
    title: str
    short: str
    code: int
    support: str
    text: Rich
    ramp: Rich
    control_bits: tuple[BitRow, ...]
    status_bits: tuple[BitRow, ...]
    objects: tuple[ModeObject, ...]
    recipes: tuple[RecipeView, ...]
    source: Rich
    errata: Rich


class HomingView(NamedTuple):
    id: str
    method: int
    name: str
    title: str
    text: Rich
    switch: str
    direction: str
    edge: str
    reverse_at: str
    index_pulse: str
    needs_power: str
    source: Rich
    errata: Rich


class RampView(NamedTuple):
    id: str
    symbol: str
    name: str
    object: Rich
    unit: str
    default: str
    text: Rich
    source: Rich


class StateView(NamedTuple):
    id: str
    name: str
    title: str
    pattern: str
    power: str
    text: Rich
    source: Rich


class CommandView(NamedTuple):
    id: str
    name: str
    title: str
    pattern: str
    text: Rich
    transitions: Rich
    source: Rich


class TransitionView(NamedTuple):
    """`starts` and `end` are names of states, `label` is what a diagram writes at the arrow."""

    id: str
    number: int
    starts: tuple[str, ...]
    end: str
    start_titles: Rich
    end_title: Rich
    by: Rich
    label: str
    text: Rich
    source: Rich


class EmergencyView(NamedTuple):
    id: str
    code: str
    name: str
    title: str
    frame: str
    scope: str
    register: Rich
    condition: Rich
    reaction: str
    reaction_text: Rich
    momentary: bool
    cause: Rich
    remedy: Rich
    source: Rich
    errata: Rich


class ErratumView(NamedTuple):
    id: str
    severity: str
    title: str
    printed: Rich
    modelled: Rich
    why: Rich
    evidence: Rich
    vendor: Rich
    paths: Rich
    source: Rich


class DifferenceView(NamedTuple):
    """One kind of fact in which our EDS differs from the vendor's: where, what each says, and why."""

    fact: str
    where: Rich
    vendor: Rich
    ours: Rich
    why: Rich
    erratum: Rich


class GroupView(NamedTuple):
    id: str
    name: str
    text: Rich
    saved_by: Rich
    restored_by: Rich
    objects: Rich


class LedRow(NamedTuple):
    title: str
    phases: str
    when: str
    text: Rich


class LedView(NamedTuple):
    id: str
    title: str
    colour: str
    rows: tuple[LedRow, ...]
    source: Rich
