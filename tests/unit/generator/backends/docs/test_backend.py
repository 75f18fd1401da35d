"""The reference: complete, linked without loose ends, and harmless whatever the spec says."""

from __future__ import annotations

import json
import posixpath
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from html.parser import HTMLParser
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from markdown_it import MarkdownIt

from odsmith import escape
from odsmith.backends.docs import DocsBackend
from odsmith.backends.docs.view import FACTS
from odsmith.canopen_types import Access, DataType, ObjectType, PdoDirection, Source
from odsmith.model import (
    Allowed,
    AxisArea,
    Bit,
    Default,
    Device,
    EdsInfo,
    Emergency,
    Entry,
    Erratum,
    HomingMethod,
    Identity,
    Mode,
    NamedValue,
    Object,
    Pdo,
    PdoMapEntry,
    RampParameter,
    Recipe,
    Revision,
    Step,
)
from odsmith.render import MARK
from odsmith.vocabulary import (
    AbortCode,
    Condition,
    Effect,
    Led,
    LedPattern,
    Named,
    NmtCommand,
    NmtState,
    PdsCommand,
    PdsState,
    RegisterBit,
    Signature,
    Transition,
    Unit,
    Vocabulary,
)

HOSTILE = (
    "- x <script>alert(1)</script> --> <!-- a|b `c|d` `` */ \"q\" 'q' &lt; [l](http://x.example) ![i](j)\n\n"
    "# h\n| cell |\n```\n~~~\n<b onclick=x> \\ \\| {{ j }} {% j %} *e* _e_ 6040h! 8611h E1 target_position "
    "</td></table>"
)
SOURCE = (
    Source("manual", HOSTILE, (1, 2), (3,), "", HOSTILE),
    Source("own_manual", HOSTILE),
    Source("inferred", note=HOSTILE),
)


# ---- a small device in which every text is hostile -------------------------------------------------------------------


def entry(sub: int, name: str, **facts: Any) -> Entry:
    given: dict[str, Any] = {
        "title": HOSTILE,
        "parameter_name": HOSTILE,
        "type": DataType.UNSIGNED16,
        "access": Access.RW,
        "mapping": PdoDirection.NO,
        "default": Default(1),
        "text": HOSTILE,
        "effect": "value",
        "source": SOURCE,
    }
    return Entry(sub=sub, name=name, **{**given, **facts})


def variable(index: int, name: str, stride: int = 0x800, title: str = HOSTILE, **facts: Any) -> Object:
    return Object(index, name, title, HOSTILE, ObjectType.VAR, (entry(0, name, **facts),), HOSTILE, SOURCE, stride)


UNIT = Unit("pps", HOSTILE[:9], "velocity", HOSTILE[:9], 3, 4, HOSTILE, "target_position", ((1, "pps"),))
SAVE = Signature("save", 0x65766173, HOSTILE)
CONTROLWORD = variable(
    0x6040,
    "controlword",
    mapping=PdoDirection.RX,
    role="controlword",
    bits=(Bit(0, 0, "switch_on", HOSTILE), Bit(4, 6, "mode_specific", HOSTILE, supported=False)),
    allowed=Allowed(((0, 3), (7, 7)), listed=True),
    writable_in=("fault",),
    hidden_default=HOSTILE,
    refuse_write_on_scan=True,
)
TARGET = variable(
    0x607A,
    "target_position",
    mapping=PdoDirection.BOTH,
    stored="motor",
    unit=UNIT,
    values=(NamedValue(1, "one", HOSTILE),),
)
STORE = Object(
    0x1010,
    "store",
    HOSTILE,
    HOSTILE,
    ObjectType.ARRAY,
    (
        entry(0, "highest_sub_index", access=Access.RO, effect="", default=Default(2)),
        entry(1, "all", type=DataType.UNSIGNED32, signatures=(SAVE,), groups=("motor",)),
        entry(2, "more", type=DataType.UNSIGNED32, signatures=(SAVE,), bits=(Bit(31, 31, "top", HOSTILE),)),
    ),
    HOSTILE,
    SOURCE,
)
NAME = variable(0x1008, "device_name", 0, type=DataType.VISIBLE_STRING, length=9, default=Default(text=HOSTILE))
RPDO = Object(
    0x1400,
    "rpdo_communication",
    "RPDO {number} communication",
    "RPDO {number} Communication",
    ObjectType.RECORD,
    (entry(1, "cob_id", type=DataType.UNSIGNED32, role="pdo_cob_id"),),
    HOSTILE,
    SOURCE,
    0x40,
    1,
    "rpdo_communication",
)
EDS = EdsInfo("toy.eds", 1, 1, HOSTILE, HOSTILE, "11-22-2026", "09:00AM", HOSTILE, "11-22-2026", "09:00AM")
STEPS = (
    Step("write", (("controlword", 0x1F), ("target_position", 1)), HOSTILE, "E1"),
    Step("expect", (("state", "fault"), ("status_bit", "reached"), ("target_position", 1)), HOSTILE),
    Step("command", (("command", "shutdown"),)),
    Step("wait", (("milliseconds", 100),)),
    Step("input", (("home", 1),)),
)
TOY = Device(
    identifier="toy",
    title=HOSTILE,
    digest="0123abcd",
    identity=Identity(
        identifier="toy",
        name=HOSTILE,
        title=HOSTILE,
        text=HOSTILE,
        version=HOSTILE,
        vendor=HOSTILE,
        vendor_id=1,
        product_code=2,
        revision_number=3,
        order_code=HOSTILE,
        profile=402,
        manual=HOSTILE,
        own_manual=HOSTILE,
        vendor_eds=HOSTILE,
        bit_rates=(125, 250),
        digital_inputs=1,
        digital_outputs=2,
        analog_inputs=3,
        analog_outputs=4,
        eds=EDS,
        firmware=(Revision("1.0", "2019-01-01", HOSTILE),),
        changes=(Revision("2.0", "2020-01-01", HOSTILE),),
    ),
    axes=2,
    areas=(AxisArea("profile", 0x6000, 0x67FF, 0x800), AxisArea("device_wide", 0x1000, 0x13FF, 0)),
    objects=(NAME, STORE, RPDO, CONTROLWORD, TARGET),
    pdos=(
        Pdo(
            "rpdo",
            1,
            Default(0x40000200, node_id=True),
            Default(0xC0000000),
            0xFF,
            (PdoMapEntry(CONTROLWORD, CONTROLWORD.entries[0]), PdoMapEntry(STORE, STORE.entries[1])),
            source=SOURCE,
        ),
    ),
    max_pdo_entries=3,
    modes=(
        Mode("no_mode", 0, "none", HOSTILE, None, HOSTILE, source=SOURCE),
        Mode(
            "profile_position",
            1,
            "pp",
            HOSTILE,
            0,
            HOSTILE,
            (Bit(4, 4, "new_set_point", HOSTILE),),
            (Bit(10, 10, "reached", HOSTILE),),
            ("controlword", "target_position"),
            "target_position",
            (Recipe("move", HOSTILE, HOSTILE, STEPS, SOURCE),),
            SOURCE,
        ),
    ),
    homing_methods=(
        HomingMethod(
            "negative_limit", 17, HOSTILE, HOSTILE, "negative_limit", -1, 1, False, "none", True, source=SOURCE
        ),
    ),
    ramp=(RampParameter("v_max", HOSTILE, "target_position", HOSTILE, SOURCE),),
    storage_groups={"motor": Named("motor", HOSTILE)},
    emergencies=(
        Emergency(
            "following_error",
            0x8611,
            HOSTILE,
            (0, "axis", 0, 0, 0),
            ("generic",),
            "lag",
            "stop",
            True,
            0,
            HOSTILE,
            HOSTILE,
            SOURCE,
        ),
    ),
    errata=(
        Erratum(
            "E1",
            "A",
            HOSTILE,
            HOSTILE,
            HOSTILE,
            HOSTILE,
            HOSTILE,
            ("objects.controlword.access", "modes.profile_position", "pds.transitions.1", "nowhere.at_all"),
            SOURCE,
            (("access", HOSTILE), ("default", HOSTILE)),
        ),
    ),
    roles={},
    effects={"value": Effect("value", HOSTILE)},
    conditions={"lag": Condition("lag", "axis", HOSTILE)},
    reactions={"stop": Named("stop", HOSTILE, HOSTILE)},
    register_bits={"generic": RegisterBit("generic", 0, HOSTILE)},
    signatures={"save": SAVE},
    abort_codes=(AbortCode("toggle_bit", 0x05030000, HOSTILE, True, HOSTILE, SOURCE),),
    nmt_states=(NmtState("operational", 5, HOSTILE, ("sdo",), HOSTILE, SOURCE),),
    nmt_commands=(NmtCommand("start", 1, "operational", HOSTILE, HOSTILE, SOURCE),),
    leds=(
        Led(
            "run", HOSTILE, "green", (LedPattern("on", HOSTILE, "", (200, 200), ("operational",), 1, HOSTILE),), SOURCE
        ),
    ),
    pds_states=(
        PdsState("not_ready", HOSTILE, 0x4F, 0, False, HOSTILE, SOURCE),
        PdsState("fault", HOSTILE, 0x4F, 8, True, HOSTILE, SOURCE),
    ),
    pds_commands=(PdsCommand("shutdown", HOSTILE, 0x87, 6, 0x40, HOSTILE, SOURCE),),
    pds_events=(Named("power_on", HOSTILE),),
    transitions=(
        Transition(0, (), "not_ready", ("power_on",), HOSTILE, SOURCE),
        Transition(1, ("not_ready",), "fault", ("shutdown", "power_on"), HOSTILE, SOURCE),
        Transition(2, ("fault", "not_ready"), "not_ready", ("shutdown",), HOSTILE, SOURCE),
    ),
    mode_codes=(),
    units={"pps": UNIT},
)


# ---- reading what was written ----------------------------------------------------------------------------------------


def pages(model: Device | Vocabulary) -> dict[str, str]:
    """The outputs by file name."""
    return {output.path.split("/docs/", 1)[1]: output.content.decode() for output in DocsBackend().render(model)}


VOID = {"meta", "br", "hr", "img", "input", "circle", "rect", "path"}


@dataclass
class Reading(HTMLParser):
    """What an HTML document holds; a closing tag without its opening one is an error."""

    open: list[str] = field(default_factory=list)
    tags: Counter[str] = field(default_factory=Counter)
    attributes: list[tuple[str, str, str]] = field(default_factory=list)
    ids: list[str] = field(default_factory=list)
    links: list[str] = field(default_factory=list)
    comments: list[str] = field(default_factory=list)
    headings: list[str] = field(default_factory=list)
    scripts: str = ""
    styles: str = ""
    words: str = ""

    def __post_init__(self) -> None:
        super().__init__(convert_charrefs=True)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags[tag] += 1
        self.attributes += [(tag, name, value or "") for name, value in attrs]
        self.ids += [value or "" for name, value in attrs if name == "id"]
        self.links += [value or "" for name, value in attrs if tag == "a" and name == "href"]
        if re.fullmatch("h[1-6]", tag):
            self.headings.append("")
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags[tag] += 1
        self.attributes += [(tag, name, value or "") for name, value in attrs]

    def handle_endtag(self, tag: str) -> None:
        assert self.open, f"</{tag}> closes nothing"
        assert self.open.pop() == tag, f"</{tag}> at {self.getpos()}"

    def handle_comment(self, data: str) -> None:
        self.comments.append(data)

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] == "script":
            self.scripts += data
        elif self.open and self.open[-1] == "style":
            self.styles += data
        else:
            self.words += data
            if any(re.fullmatch("h[1-6]", tag) for tag in self.open):
                self.headings[-1] += data


def reading(html: str) -> Reading:
    found = Reading()
    found.feed(html)
    found.close()
    assert not found.open, f"never closed: {found.open}"
    return found


def rendered(markdown: str) -> Reading:
    """Markdown as a repository shows it."""
    return reading(MarkdownIt("commonmark", {"html": True}).enable("table").render(markdown))


def slug(heading: str) -> str:
    """The anchor that GitHub gives a heading."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def anchors(page: Reading) -> set[str]:
    return {*page.ids, *map(slug, page.headings)}


def tables(markdown: str) -> Iterator[list[str]]:
    """The lines of each table, fenced code left out."""
    lines: list[str] = []
    for line in (*re.sub(r"(?ms)^```.*?^```$", "", markdown).splitlines(), ""):
        if line.startswith("|"):
            lines.append(line)
        elif lines:
            yield lines
            lines = []


def folded(text: str) -> str:
    return re.sub(r"\s+", " ", text)


@pytest.fixture(scope="module")
def toy() -> dict[str, str]:
    return pages(TOY)


each_device = pytest.mark.parametrize("device", ["toy", pytest.param("drive", marks=pytest.mark.slow)])


@pytest.fixture(scope="module")
def drive(tmcm3230: Device) -> dict[str, str]:
    return pages(tmcm3230)


# ---- harmless --------------------------------------------------------------------------------------------------------

MARKDOWN_TAGS = {
    *("a", "h1", "h2", "h3", "p", "ul", "ol", "li", "table", "thead", "tbody", "tr", "th", "td"),
    *("code", "pre", "strong", "em"),
}


def markdown_pages(found: dict[str, str]) -> dict[str, str]:
    return {name: text for name, text in found.items() if name.endswith(".md")}


@each_device
def test_markdown_has_no_markup_but_ours(device: str, request: pytest.FixtureRequest) -> None:
    for name, text in markdown_pages(request.getfixturevalue(device)).items():
        page = rendered(text)
        assert set(page.tags) <= MARKDOWN_TAGS, name
        assert {attribute for _, attribute, _ in page.attributes} <= {"id", "href", "class", "start"}, name
        assert len(page.comments) == 1, name
        assert not [link for link in page.links if ":" in link], name


@each_device
def test_tables_of_markdown_have_rows_of_one_length(device: str, request: pytest.FixtureRequest) -> None:
    for name, text in markdown_pages(request.getfixturevalue(device)).items():
        for lines in tables(text):
            lengths = {len(re.split(r"(?<!\\)(?:\\\\)*\|", line)) for line in lines}
            assert len(lengths) == 1, f"{name}: {lines}"
            assert re.fullmatch(r"[|-]+", lines[1]), f"{name}: {lines[1]}"
            assert all(line.endswith("|") for line in lines), name


@each_device
def test_html_is_balanced_and_has_one_script_which_is_ours(
    device: str, request: pytest.FixtureRequest, root: Path
) -> None:
    page = reading(request.getfixturevalue(device)["index.html"])
    script = (root / "templates" / "docs" / "device" / "_script.js").read_text(encoding="utf-8")
    assert page.tags["script"] == 1
    assert page.scripts.strip() == script.strip()
    assert not [name for _, name, _ in page.attributes if name.startswith("on")]
    assert not set(page.tags) & {"img", "iframe", "link", "object", "embed", "form", "b"}
    assert page.comments == [comment for comment in page.comments if MARK in comment]


@each_device
def test_html_asks_nobody_for_anything(device: str, request: pytest.FixtureRequest) -> None:
    page = reading(request.getfixturevalue(device)["index.html"])
    assert not [item for item in page.attributes if item[1] in ("src", "srcset", "action", "data", "poster")]
    assert {value[:1] for _, name, value in page.attributes if name in ("href", "xlink:href")} == {"#"}
    assert not re.search(r"url\((?!#)|@import|https?:", page.styles)
    assert not re.search(r"fetch\(|XMLHttpRequest|import\(|WebSocket|https?:|eval\(|innerHTML", page.scripts)
    policy = [value for tag, name, value in page.attributes if (tag, name) == ("meta", "content")]
    assert any("default-src 'none'" in value for value in policy)


def test_a_hostile_text_arrives_as_it_was_written(toy: dict[str, str]) -> None:
    # Only back-ticks around a stretch of code go, and white space is folded.
    wanted = escape.one_line(HOSTILE).replace("`", "")
    assert wanted in folded(reading(toy["index.html"]).words).replace("`", "")
    for file in ("objects-profile.md", "emergencies.md", "errata.md", "vendor-eds.md", "modes.md", "state-machine.md"):
        assert wanted in folded(rendered(toy[file]).words).replace("`", ""), file


def test_mermaid_labels_hold_no_markup(toy: dict[str, str]) -> None:
    diagram = re.search(r"(?ms)^```mermaid\n(.*?)^```$", toy["state-machine.md"])
    assert diagram
    for line in diagram[1].splitlines()[1:]:
        assert re.fullmatch(r'    (?:state "[\w .,()/+-]*" as \w+|(?:\w+|\[\*\]) --> \w+: [\w .,()/+-]+)', line), line


# ---- linked ----------------------------------------------------------------------------------------------------------


def check_links(found: dict[str, str]) -> int:
    """Every link of every page leads to a page and an anchor that are there."""
    read = {name: rendered(text) for name, text in markdown_pages(found).items()}
    known = {name: anchors(page) for name, page in read.items()}
    checked = 0
    for name, page in read.items():
        assert len(page.ids) == len(set(page.ids)), f"{name}: an anchor stands twice"
        for link in page.links:
            file, _, anchor = link.partition("#")
            file = posixpath.normpath(posixpath.join(posixpath.dirname(name), file)) if file else ""
            assert not file or file in found, f"{name}: no page {link}"
            assert not anchor or anchor in known[file or name], f"{name}: no anchor {link}"
            checked += 1
    return checked


@each_device
def test_links_of_markdown_lead_somewhere(device: str, request: pytest.FixtureRequest) -> None:
    assert check_links(request.getfixturevalue(device)) > 20


def test_links_of_the_vocabulary_lead_somewhere(vocabulary: Vocabulary) -> None:
    assert check_links(pages(vocabulary)) > 100


def test_links_of_a_device_without_axes_lead_somewhere(io_module: Device) -> None:
    assert check_links(pages(io_module)) > 20


@each_device
def test_links_of_html_lead_somewhere(device: str, request: pytest.FixtureRequest) -> None:
    page = reading(request.getfixturevalue(device)["index.html"])
    assert len(page.ids) == len(set(page.ids)), [name for name, count in Counter(page.ids).items() if count > 1]
    assert {link[1:] for link in page.links} <= set(page.ids)
    labelled = {"aria-controls", "aria-labelledby", "aria-describedby", "for"}
    assert {value for _, name, value in page.attributes if name in labelled} <= set(page.ids)


def test_words_of_a_text_become_links(drive: dict[str, str], toy: dict[str, str]) -> None:
    assert "[6060h](objects-profile.md#6060h)" in drive["errata.md"]
    assert "(emergencies.md#emergency-following_error)" in drive["modes.md"]
    assert "[E1](errata.md#E1)" in toy["modes.md"]
    assert "[`target_position`](objects-profile.md#607Ah)" in toy["modes.md"]


# ---- complete --------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def words(drive: dict[str, str]) -> tuple[str, str]:
    """All text of the Markdown pages, and all of the HTML page."""
    markdown = " ".join(rendered(text).words for text in markdown_pages(drive).values())
    return folded(markdown), folded(reading(drive["index.html"]).words)


def facts(device: Device) -> Iterator[str]:
    """Everything that a reader may look for."""
    for obj in device.expanded:
        if not obj.object.pdo:
            yield f"{obj.index:04X}h"
            yield escape.one_line(obj.parameter_name)
    for item in device.objects:
        yield item.title.replace("{number}", "n")
        yield item.name
        for sub in item.entries:
            yield sub.title.replace("{number}", "n")
            yield from (bit.name for bit in sub.bits)
            yield from (value.name for value in sub.values)
            yield from (escape.one_line(bit.text) for bit in sub.bits if "`" not in bit.text)
    for mode in device.modes:
        yield mode.title
        yield from (bit.name for bit in (*mode.control_bits, *mode.status_bits))
        yield from (recipe.title for recipe in mode.recipes)
    for row in device.emergencies:
        yield f"{row.code:04X}h {row.title}"
        yield from (escape.one_line(text) for text in (row.cause, row.remedy))
    for code in device.abort_codes:
        yield f"{code.code:08X}h"
        yield escape.one_line(code.why)
    for erratum in device.errata:
        yield f"{erratum.id} {erratum.title}"
        yield escape.one_line(erratum.modelled)
        yield from erratum.paths
    for group in (device.pds_states, device.pds_commands, device.nmt_states, device.nmt_commands, device.leds):
        yield from (element.title for element in group)
    yield from (escape.one_line(transition.text) for transition in device.transitions)
    yield from (f"Method {method.method}: {method.title}" for method in device.homing_methods)
    yield from (parameter.symbol for parameter in device.ramp)
    yield from (escape.one_line(group.text) for group in device.storage_groups.values())
    yield from (revision.text for revision in (*device.identity.firmware, *device.identity.changes))


def test_everything_in_the_model_is_in_the_reference(tmcm3230: Device, words: tuple[str, str]) -> None:
    wanted = {fact.replace("`", "") for fact in facts(tmcm3230) if fact}
    assert len(wanted) > 1000
    for text in words:
        plain = text.replace("`", "")
        assert not sorted(fact for fact in wanted if fact not in plain)


def test_eds_names_come_with_the_way_they_count(drive: dict[str, str]) -> None:
    for name in ("objects-manufacturer.md", "objects-profile.md"):
        lines = [line for line in drive[name].splitlines() if line.startswith("| EDS name |") and " 1`" in line]
        assert lines
        assert all("EDS names count axes from 1" in line for line in lines if "for axes" in line)
    assert "axes count from 0" in drive["README.md"].lower()


def test_html_finds_an_object_by_the_index_of_any_axis(drive: dict[str, str]) -> None:
    found = re.search(r'<article id="6040h"[^>]*>', drive["index.html"])
    assert found
    assert 'data-index="24640" data-stride="2048" data-length="1"' in found[0]
    found = re.search(r'<article id="1400h"[^>]*>', drive["index.html"])
    assert found
    assert 'data-index="5120" data-stride="64" data-length="4"' in found[0]
    assert '<body data-axes="3">' in drive["index.html"]


def test_recipes_name_objects_values_and_added_steps(drive: dict[str, str]) -> None:
    assert re.search(r"(?m)^\d+\. Write `1` \(`profile_position`\) to \[`modes_of_operation`\]", drive["modes.md"])
    assert "`000Fh` (`enable_operation`)" in drive["modes.md"]
    assert re.search(
        r"(?m)^\d+\. Write .* \*\(Not in the manual, see \[E81\]\(errata.md#E81\)\.\)\*$", drive["modes.md"]
    )


# ---- what goes, goes everywhere --------------------------------------------------------------------------------------


def test_a_transition_that_goes_leaves_table_diagram_and_html(tmcm3230: Device, drive: dict[str, str]) -> None:
    rest = tuple(transition for transition in tmcm3230.transitions if transition.number != 16)
    without = pages(replace(tmcm3230, transitions=rest))
    for name, trace in (
        ("state-machine.md", "quick_stop_active --> operation_enabled: 16"),
        ("state-machine.md", 'id="transition-16"'),
        ("index.html", 'id="transition-16"'),
        ("index.html", 'class="wire" href="#transition-16"'),
    ):
        assert trace in drive[name]
        assert trace not in without[name]


@pytest.mark.parametrize(
    ("section", "file"),
    [
        ("modes", "modes.md"),
        ("homing_methods", "homing.md"),
        ("ramp", "ramp.md"),
        ("transitions", "state-machine.md"),
        ("emergencies", "emergencies.md"),
        ("abort_codes", "abort-codes.md"),
        ("pdos", "pdos.md"),
        ("nmt_states", "nmt.md"),
    ],
)
def test_what_a_device_lacks_has_no_page(section: str, file: str) -> None:
    objects = tuple(obj for obj in TOY.objects if not obj.pdo) if section == "pdos" else TOY.objects
    without: dict[str, Any] = {section: ()}
    found = pages(replace(TOY, objects=objects, **without))
    assert file in pages(TOY)
    assert file not in found
    assert file not in found["README.md"]
    assert f'<section id="{file.removesuffix(".md")}"' not in found["index.html"]


def test_differences_from_the_vendors_eds_stand_in_a_table_by_fact(tmcm6212: Device) -> None:
    found = pages(tmcm6212)
    rows = [line.split(" | ") for line in found["vendor-eds.md"].splitlines() if line.startswith("| ")][1:]
    wanted = [(fact, erratum.id) for erratum in tmcm6212.errata for fact, _ in erratum.vendor]
    assert sorted((row[0][2:], row[-1].split("]")[0][1:]) for row in rows) == sorted(wanted)
    assert [row[0][2:] for row in rows] == sorted((row[0][2:] for row in rows), key=FACTS.index)
    default = next(row for row in rows if "#E113" in row[-1])
    assert default[1:3] == ["[20B9h](objects-manufacturer.md#20B9h)", "0"]
    assert '<section id="vendor-eds"' in found["index.html"]
    assert "| The vendor's EDS | default: 0 |" in found["errata.md"]


def test_a_device_without_a_vendors_eds_does_not_compare(drive: dict[str, str]) -> None:
    assert "vendor-eds.md" not in drive
    assert "| The vendor's EDS |" not in drive["errata.md"]
    assert 'id="vendor-eds"' not in drive["index.html"]


def test_facts_are_those_of_the_schema(root: Path) -> None:
    schema = json.loads((root / "spec" / "schema.json").read_text(encoding="utf-8"))
    assert schema["$defs"]["erratum"]["properties"]["vendor"]["propertyNames"]["enum"] == list(FACTS)


def test_a_device_without_axes_says_nothing_about_axes(io_module: Device) -> None:
    found = pages(io_module)
    assert set(found) >= {"README.md", "index.html", "objects-communication.md", "emergencies.md"}
    assert not set(found) & {"modes.md", "state-machine.md", "homing.md", "ramp.md"}
    for text in found.values():
        page = rendered(text) if not text.startswith("<!doctype") else reading(text)
        assert not re.search(r"\baxis\b|\baxes\b", re.sub(r"(?i)without axes", "", page.words), re.IGNORECASE)


# ---- files -----------------------------------------------------------------------------------------------------------


def test_every_file_carries_the_mark_in_a_comment_near_its_top(drive: dict[str, str], vocabulary: Vocabulary) -> None:
    for text in (*drive.values(), *pages(vocabulary).values()):
        assert f"<!-- {MARK}" in "".join(text.splitlines(keepends=True)[:2])
        assert text.endswith("\n")
        assert not text.endswith("\n\n")
        assert not re.search(r"[ \t]$", text, re.MULTILINE)


def test_two_renderings_are_equal(tmcm3230: Device, drive: dict[str, str]) -> None:
    assert pages(tmcm3230) == drive


def test_headings_do_not_skip_a_level(drive: dict[str, str]) -> None:
    levels = [int(level) for level in re.findall(r"<h([1-6])\b", drive["index.html"])]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(after - before <= 1 for before, after in pairwise(levels))
