"""What the reference says about everything but objects: PDOs, recipes, emergencies, storage, errata."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator

from odsmith.backends.docs.links import hexadecimal, link_of
from odsmith.backends.docs.objects import (
    bit_row,
    default_text,
    errata_by_path,
    erratum_links,
    numbered_title,
    sources,
)
from odsmith.backends.docs.rows import (
    CommandView,
    DifferenceView,
    EmergencyView,
    ErratumView,
    GroupView,
    HomingView,
    LedRow,
    LedView,
    ModeObject,
    ModeView,
    PdoRow,
    PdoTable,
    RampView,
    RecipeView,
    StateView,
    StepView,
    TransitionView,
)
from odsmith.backends.docs.text import Piece, Reader, Rich, code, joined, plain
from odsmith.canopen_types import Source
from odsmith.model import Device, Emergency, Entry, Erratum, Mode, Object, Pdo, Recipe, Step
from odsmith.vocabulary import LedPattern, PdsCommand, PdsState, Transition


class DeviceWriter:
    """Describes one device; each method makes the rows of one page."""

    def __init__(self, device: Device, elements: dict[str, str], read: Reader) -> None:
        self.device = device
        self.elements = elements
        self.read = read
        self.errata_by_path = errata_by_path(device)

    def source(self, found: Iterable[Source]) -> Rich:
        return self.read(sources(found))

    def errata(self, path: str) -> Rich:
        """The errata that decide something at or below a path."""
        return erratum_links(self.errata_by_path.get(path, ()))

    def element(self, path: str, label: str) -> Rich:
        """A label that leads to an element where that has a place in the reference."""
        return (Piece(label, self.elements.get(path, "")),)

    # ---- PDOs --------------------------------------------------------------------------------------------------------

    def pdo_tables(self) -> tuple[PdoTable, ...]:
        titles = {"rpdo": "RPDOs: what the device receives", "tpdo": "TPDOs: what the device sends"}
        tables = (
            PdoTable(
                title,
                tuple(
                    self._pdo(pdo, axis)
                    for axis in range(max(self.device.axes, 1))
                    for pdo in self.device.pdos
                    if pdo.kind == kind
                ),
            )
            for kind, title in titles.items()
        )
        return tuple(table for table in tables if table.rows)

    def _pdo(self, pdo: Pdo, axis: int) -> PdoRow:
        cob_id = pdo.other_axes_cob_id if axis else pdo.cob_id
        parameters = [obj for obj in self.device.objects if obj.pdo.startswith(pdo.kind)]
        indices = [obj.index + axis * obj.stride + pdo.number - 1 for obj in parameters]
        number = (indices[0] & 0x1FF) + 1 if indices else pdo.number
        mapped = []
        for item in pdo.map:
            sub = f":{item.entry.sub:02X}" if item.object.highest_sub else ""
            index = hexadecimal(item.object.index + axis * item.object.stride)
            label = f"{index}{sub} {_entry_title(item.object, item.entry)}"
            mapped.append(self.element(f"objects.{item.object.name}", label))
        return PdoRow(
            id="" if axis else f"{pdo.kind}-{pdo.number}",
            number=f"{pdo.kind.upper()} {number}",
            axis=axis,
            indices=", ".join(hexadecimal(index) for index in indices),
            cob_id=hexadecimal(cob_id.number, 8) + (" + node-ID" if cob_id.node_id else ""),
            active=not cob_id.number >> 31,  # bit 31 set: the PDO does not exist (CiA 301, 7.5.2.35)
            transmission=hexadecimal(pdo.transmission_type, 2),
            inhibit_time=pdo.inhibit_time,
            event_timer=pdo.event_timer,
            mapped=joined(mapped) if mapped else plain("nothing"),
            source=self.source(pdo.source),
        )

    # ---- modes -------------------------------------------------------------------------------------------------------

    def modes(self) -> tuple[ModeView, ...]:
        return tuple(self._mode(mode) for mode in self.device.modes)

    def _mode(self, mode: Mode) -> ModeView:
        ramp = self.device.object(mode.slow_down_ramp)
        return ModeView(
            id=f"mode-{mode.name}",
            title=mode.title,
            short=mode.short,
            code=mode.code,
            support="no bit" if mode.bit is None else f"bit {mode.bit}",
            text=self.read(mode.text),
            ramp=self._object(ramp) if ramp else (),
            control_bits=tuple(bit_row(bit, self.read) for bit in mode.control_bits),
            status_bits=tuple(bit_row(bit, self.read) for bit in mode.status_bits),
            objects=tuple(self._mode_object(obj) for obj in map(self.device.object, mode.objects) if obj),
            recipes=tuple(self._recipe(mode, recipe) for recipe in mode.recipes),
            source=self.source(mode.source),
            errata=self.errata(f"modes.{mode.name}"),
        )

    def _object(self, obj: Object) -> Rich:
        return self.element(f"objects.{obj.name}", f"{hexadecimal(obj.index)} {numbered_title(obj)}")

    def _mode_object(self, obj: Object) -> ModeObject:
        units = dict.fromkeys(entry.unit.symbol for entry in obj.entries if entry.unit)
        access = dict.fromkeys(entry.access.value for entry in obj.entries if entry.sub or not obj.highest_sub)
        return ModeObject(
            address=self.element(f"objects.{obj.name}", hexadecimal(obj.index)),
            title=numbered_title(obj),
            access=", ".join(access),
            unit=", ".join(units),
        )

    def _recipe(self, mode: Mode, recipe: Recipe) -> RecipeView:
        return RecipeView(
            id=f"recipe-{mode.name}-{recipe.name}",
            title=recipe.title,
            text=self.read(recipe.text),
            steps=tuple(self._step(mode, step) for step in recipe.steps),
            source=self.source(recipe.source),
        )

    def _step(self, mode: Mode, step: Step) -> StepView:
        actions = {
            "write": self._write,
            "expect": self._expect,
            "command": self._command,
            "wait": lambda _, __, value: plain(f"Wait {value} ms"),
            "input": lambda _, name, value: (Piece("Input "), *code(name), Piece(f" becomes {value}")),
        }
        act: Callable[[Mode, str, int | str], Rich] = actions[step.kind]
        return StepView(
            action=joined((act(mode, name, value) for name, value in step.arguments), "; "),
            text=self.read(step.text),
            added=self.element(f"errata.{step.added}", step.added) if step.added else (),
        )

    def _entry(self, name: str) -> tuple[Rich, Entry | None]:
        """An entry that a recipe calls `object` or `object.sub_name`."""
        object_name, _, sub_name = name.partition(".")
        obj = self.device.object(object_name)
        if obj is None:
            return code(name), None
        entry = next((entry for entry in obj.entries if entry.name == (sub_name or obj.name)), None)
        sub = f":{entry.sub:02X}" if entry and obj.highest_sub else ""
        link = self.elements.get(f"objects.{object_name}", "")
        return (*code(name, link), Piece(f" ({hexadecimal(obj.index)}{sub})")), entry

    def _write(self, mode: Mode, name: str, value: int | str) -> Rich:
        shown, entry = self._entry(name)
        return (Piece("Write "), *self._value(mode, entry, value), Piece(" to "), *shown)

    def _expect(self, mode: Mode, name: str, value: int | str) -> Rich:
        if name == "state":
            state = next((state.title for state in self.device.pds_states if state.name == value), str(value))
            return (Piece("Wait for the state "), *self.element(f"pds.states.{value}", state))
        if name == "status_bit":
            return (Piece("Wait for the bit "), *code(str(value)), Piece(" of the statusword"))
        shown, entry = self._entry(name)
        return (Piece("Wait until "), *shown, Piece(" is "), *self._value(mode, entry, value))

    def _command(self, mode: Mode, name: str, value: int | str) -> Rich:
        title = next((item.title for item in self.device.pds_commands if item.name == value), str(value))
        return (Piece("Give the command "), *self.element(f"pds.commands.{value}", title))

    def _value(self, mode: Mode, entry: Entry | None, value: int | str) -> Rich:
        """A number, and what it means: the name of a value, the command and bits of a controlword."""
        names: list[str] = []
        if entry and isinstance(value, int):
            names += [item.name for item in entry.values if item.value == value]
            if entry.role == "controlword":
                # Where commands share a pattern the shortest name says it best.
                commands = [c.name for c in self.device.pds_commands if c.mask and value & c.mask == c.value]
                names += sorted(commands, key=len)[:1]
                names += [bit.name for bit in mode.control_bits if value & bit.mask]
            else:
                names += [bit.name for bit in entry.bits if bit.low == bit.high and value & bit.mask]
            if entry.bits and not entry.unit:
                value = f"{hexadecimal(value, max(1, entry.bit_length // 4))}"
        meaning = [code(name) for name in names]
        return (*code(str(value)), Piece(" ("), *joined(meaning), Piece(")")) if meaning else code(str(value))

    # ---- homing and ramp ---------------------------------------------------------------------------------------------

    def homing(self) -> tuple[HomingView, ...]:
        ways = {-1: "negative", 0: "none", 1: "positive"}
        return tuple(
            HomingView(
                id=f"homing-{method.name}",
                method=method.method,
                name=method.name,
                title=method.title,
                text=self.read(method.text),
                switch=words(method.switch),
                direction=ways[method.direction],
                edge=ways[method.edge],
                reverse_at=words(method.reverse_at),
                index_pulse="yes" if method.index_pulse else "no",
                needs_power="yes" if method.needs_power else "no",
                source=self.source(method.source),
                errata=self.errata(f"homing_methods.{method.name}"),
            )
            for method in self.device.homing_methods
        )

    def ramp(self) -> Iterator[RampView]:
        for parameter in self.device.ramp:
            obj = self.device.object(parameter.object)
            entry = obj.entries[0] if obj else None
            yield RampView(
                id=f"ramp-{parameter.name}",
                symbol=parameter.symbol,
                name=parameter.name,
                object=self._object(obj) if obj else code(parameter.object),
                unit=entry.unit.symbol if entry and entry.unit else "",
                default=default_text(entry, entry.default) if entry and entry.default else "none stated",
                text=self.read(parameter.text),
                source=self.source(parameter.source),
            )

    # ---- state machine -----------------------------------------------------------------------------------------------

    def states(self) -> tuple[StateView, ...]:
        return tuple(
            StateView(
                id=f"state-{state.name}",
                name=state.name,
                title=state.title,
                pattern=state_pattern(state),
                power="on" if state.power else "off",
                text=self.read(state.text),
                source=self.source(state.source),
            )
            for state in self.device.pds_states
        )

    def commands(self) -> tuple[CommandView, ...]:
        taken: dict[str, list[Rich]] = defaultdict(list)
        for transition in self.device.transitions:
            for name in transition.by:
                taken[name].append(self.element(f"pds.transitions.{transition.number}", str(transition.number)))
        return tuple(
            CommandView(
                id=f"command-{command.name}",
                name=command.name,
                title=command.title,
                pattern=command_pattern(command),
                text=self.read(command.text),
                transitions=joined(taken[command.name]),
                source=self.source(command.source),
            )
            for command in self.device.pds_commands
        )

    def transitions(self) -> tuple[TransitionView, ...]:
        return tuple(self._transition(transition) for transition in self.device.transitions)

    def _transition(self, transition: Transition) -> TransitionView:
        titles = {state.name: state.title for state in self.device.pds_states}
        commands = {command.name: command.title for command in self.device.pds_commands}

        def state(name: str) -> Rich:
            return self.element(f"pds.states.{name}", titles.get(name, name))

        def reason(name: str) -> Rich:
            if name in commands:
                return self.element(f"pds.commands.{name}", commands[name])
            return self.element(f"pds.events.{name}", words(name))

        return TransitionView(
            id=f"transition-{transition.number}",
            number=transition.number,
            starts=transition.start,
            end=transition.end,
            start_titles=joined(map(state, transition.start)) if transition.start else plain("power-on"),
            end_title=state(transition.end),
            by=joined((reason(name) for name in transition.by), " or "),
            label=" or ".join(commands.get(name, words(name)) for name in transition.by),
            text=self.read(transition.text),
            source=self.source(transition.source),
        )

    # ---- emergencies and LEDs ----------------------------------------------------------------------------------------

    def emergencies(self) -> tuple[EmergencyView, ...]:
        return tuple(self._emergency(row) for row in self.device.emergencies)

    def _emergency(self, row: Emergency) -> EmergencyView:
        reaction = self.device.reactions[row.reaction]
        bits = self.device.register_bits
        register = (
            (Piece(f"{bits[name].bit} "), *self.element(f"error_register.{name}", words(name))) for name in row.register
        )
        low, high = f"{row.code & 0xFF:02X}", f"{row.code >> 8:02X}"
        additional = " ".join("axis" if byte == "axis" else f"{byte:02X}" for byte in row.bytes)
        return EmergencyView(
            id=f"emergency-{row.name}",
            code=hexadecimal(row.code),
            name=row.name,
            title=row.title,
            frame=f"{low} {high} reg {additional}",
            scope="axis" if row.per_axis else "device",
            register=joined(register) if row.register else plain("none"),
            condition=self.read(self.device.conditions[row.condition].text),
            reaction=reaction.title or words(reaction.name),
            reaction_text=self.read(reaction.text),
            momentary=row.momentary,
            cause=self.read(row.cause),
            remedy=self.read(row.remedy),
            source=self.source(row.source),
            errata=self.errata(f"emergencies.{row.name}"),
        )

    def leds(self) -> tuple[LedView, ...]:
        return tuple(
            LedView(
                id=f"led-{led.name}",
                title=led.title,
                colour=led.colour,
                rows=tuple(
                    LedRow(pattern.title, phases(pattern), ", ".join(map(words, pattern.when)), self.read(pattern.text))
                    for pattern in led.patterns
                ),
                source=self.source(led.source),
            )
            for led in self.device.leds
        )

    # ---- storage and errata ------------------------------------------------------------------------------------------

    def groups(self) -> Iterator[GroupView]:
        members: dict[str, list[Rich]] = defaultdict(list)
        actions: dict[tuple[str, str], list[Rich]] = defaultdict(list)
        for obj in self.device.objects:
            for stored in dict.fromkeys(entry.stored for entry in obj.entries):
                members[stored].append(self._object(obj))
            for entry in obj.entries:
                label = f"{hexadecimal(obj.index)}:{entry.sub:02X} {entry.title}"
                for acted_on in entry.groups:
                    for signature in entry.signatures:
                        actions[acted_on, signature.name].append(self.element(f"objects.{obj.name}", label))
        for name, group in self.device.storage_groups.items():
            yield GroupView(
                id=f"group-{name}",
                name=name,
                text=self.read(group.text),
                saved_by=joined(actions[name, "save"]) or plain("nothing"),
                restored_by=joined(actions[name, "load"]) or plain("nothing"),
                objects=joined(members[name]) or plain("none"),
            )

    def errata_list(self) -> tuple[ErratumView, ...]:
        return tuple(self._erratum(erratum) for erratum in self.device.errata)

    def _vendor(self, erratum: Erratum) -> Rich:
        """What the vendor's EDS says of it, if there is one of this device to compare with."""
        if not self.device.identity.vendor_eds:
            return ()
        return joined(((Piece(f"{fact}: "), *self.read(said)) for fact, said in erratum.vendor), "; ")

    def differences(self) -> tuple[DifferenceView, ...]:
        """Where our EDS differs from the vendor's, by the kind of fact: what the errata say of it."""
        found = ((fact, said, erratum) for erratum in self.device.errata for fact, said in erratum.vendor)
        return tuple(
            DifferenceView(
                fact=fact,
                where=self._where(erratum),
                vendor=self.read(said),
                ours=self.read(erratum.modelled),
                why=self.read(erratum.why),
                erratum=self.element(f"errata.{erratum.id}", erratum.id),
            )
            for fact, said, erratum in sorted(found, key=lambda item: FACTS.index(item[0]))
        )

    def _where(self, erratum: Erratum) -> Rich:
        """The objects and PDOs that an erratum decides, each once; all of them if it names the whole section."""
        if "objects" in erratum.paths:
            return plain("all objects")
        places: dict[str, Rich] = {}
        for path in erratum.paths:
            section, name, *rest = (*path.split("."), "")
            obj = self.device.object(name) if section == "objects" else None
            if obj:
                places[obj.name] = self.element(f"objects.{obj.name}", hexadecimal(obj.index))
            elif section == "pdos" and rest:
                number = f"{name.upper()} {rest[0]}"
                places[number] = self.element(f"pdos.{name}.{rest[0]}", number)
        return joined(places.values())

    def _erratum(self, erratum: Erratum) -> ErratumView:
        severities = {"A": "a value", "B": "a behaviour", "C": "wording"}
        return ErratumView(
            id=erratum.id,
            severity=severities[erratum.severity],
            title=erratum.title,
            printed=self.read(erratum.printed),
            modelled=self.read(erratum.modelled),
            why=self.read(erratum.why),
            evidence=self.read(erratum.evidence),
            vendor=self._vendor(erratum),
            paths=joined(code(path, link_of(path, self.elements)) for path in erratum.paths),
            source=self.source(erratum.source),
        )


FACTS = ("existence", "name", "type", "access", "mapping", "default", "limits", "flags")
"""The kinds of facts in which two EDS files can differ, in the order in which the reference lists them."""


# ---- words -----------------------------------------------------------------------------------------------------------


def words(name: str) -> str:
    return name.replace("_", " ")


def _entry_title(obj: Object, entry: Entry) -> str:
    return f"{obj.title}, {entry.title}" if obj.highest_sub else obj.title


def pattern(mask: int, value: int, edge: int, width: int) -> str:
    """`xxxx xxxx x01x 0111`: bits from the highest down, `x` for any, `^` for a rising edge."""
    bits = "".join(
        "^" if edge >> bit & 1 else str(value >> bit & 1) if mask >> bit & 1 else "x" for bit in reversed(range(width))
    )
    return " ".join(bits[i : i + 4] for i in range(0, width, 4))


def state_pattern(state: PdsState) -> str:
    """The statusword in this state."""
    return pattern(state.mask, state.value, 0, 16)


def command_pattern(command: PdsCommand) -> str:
    """The low byte of the controlword that gives this command."""
    return pattern(command.mask, command.value, command.edge, 8)


def phases(item: LedPattern) -> str:
    """`200 ms on, 1000 ms off`, repeated."""
    if item.steady:
        return item.steady
    return ", ".join(f"{ms} ms {('on', 'off')[i % 2]}" for i, ms in enumerate(item.phases))


def arithmetic(device: Device) -> Iterator[tuple[str, str, str, tuple[str, ...]]]:
    """For each area its name, its range on axis 0, its stride (empty if it stands once), its range on every axis."""
    for area in device.areas:
        ranges = tuple(
            f"{hexadecimal(area.first + axis * area.stride)}..{hexadecimal(area.last + axis * area.stride)}"
            for axis in range(device.axes if area.stride else 1)
        )
        yield words(area.name), ranges[0], f"{hexadecimal(area.stride)}" if area.stride else "", ranges


def features(device: Device) -> Iterator[tuple[str, str]]:
    """What the device has, in numbers."""
    identity = device.identity
    if device.axes:
        yield "Axes", f"{device.axes}, counted from 0 to {device.axes - 1}" if device.axes > 1 else "1, axis 0"
    entries = sum(len(item.entries) for item in device.expanded)
    yield "Object dictionary", f"{len(device.expanded)} objects with {entries} entries"
    for kind in ("rpdo", "tpdo"):
        count = len(device.pdos_of(kind)) * max(device.axes, 1)
        if count:
            yield f"{kind.upper()}s", f"{count}, of at most {device.max_pdo_entries} entries each"
    modes = [mode for mode in device.modes if mode.bit is not None]
    if modes:
        yield "Modes of operation", ", ".join(f"{mode.title} ({mode.short})" for mode in modes)
    if device.homing_methods:
        yield "Homing methods", ", ".join(str(method.method) for method in device.homing_methods)
    yield "General inputs", _channels(identity.digital_inputs, identity.analog_inputs)
    yield "General outputs", _channels(identity.digital_outputs, identity.analog_outputs)
    yield "Bit rates", ", ".join(str(rate) for rate in identity.bit_rates) + " kbit/s"
    yield "Emergencies", f"{len(device.emergencies)} messages" if device.emergencies else "none"


def _channels(digital: int, analog: int) -> str:
    return ", ".join(f"{count} {kind}" for count, kind in ((digital, "digital"), (analog, "analog")) if count) or "none"
