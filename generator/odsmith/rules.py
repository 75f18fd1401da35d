"""The registry of rules: every finding that odsmith can report, what it means and how to mend it.

`check`, `lint`, `import` and `diff` share it, and the documentation prints it. The first digit tells the phase:
E1xx reading a file, E2xx its shape, E3xx names and references, E4xx meaning, W5xx warnings. Findings in EDS and DCF files
are called L: L1xx the text, L2xx its sections, L3xx what it says of itself and the device, L4xx objects, L5xx PDOs, L6xx
axes.
"""

from __future__ import annotations

from dataclasses import dataclass

from odsmith.canopen_types import Place
from odsmith.errors import Diagnostic, Fix, Severity


@dataclass(frozen=True, slots=True)
class Rule:
    """One rule. `title` names it in a few words, `explanation` says why it exists, `hint` is the usual remedy: a
    diagnostic of this rule shows it unless it has a better one."""

    id: str
    severity: Severity
    title: str
    explanation: str
    hint: str = ""


RULES: dict[str, Rule] = {}
"""Every rule by its id, in the order of the ids."""


def rule(rule_id: str, severity: Severity, title: str, explanation: str, hint: str = "") -> Rule:
    """Adds a rule to the registry and returns it. An id is given once; raises ValueError otherwise."""
    if rule_id in RULES:
        raise ValueError(f"rule {rule_id} exists already")
    RULES[rule_id] = Rule(rule_id, severity, title, explanation, hint)
    return RULES[rule_id]


def diagnose(
    rule_id: str,
    place: Place,
    message: str,
    hint: str = "",
    length: int = 0,
    notes: tuple[tuple[Place, str], ...] = (),
    subject: str = "",
    fix: Fix | None = None,
) -> Diagnostic:
    """A finding of a rule. `length` characters are underlined, 0 for the token at `place`."""
    broken = RULES[rule_id]
    return Diagnostic(rule_id, broken.severity, message, place, length, hint or broken.hint, notes, subject, fix)


# ---- E1xx: reading files and YAML -----------------------------------------------------------------------------------
rule("E101", "error", "file cannot be read", "A specification or an include is missing, a folder, or not readable.")
rule(
    "E102",
    "error",
    "file too large",
    "A specification is written by hand; a file of several megabytes is something else, and is not even parsed.",
    "split the file and include the parts",
)
rule(
    "E103",
    "error",
    "not a text file",
    "A specification is UTF-8 text without NUL and other control characters.",
    "save the file as UTF-8 text",
)
rule(
    "E104",
    "error",
    "byte order mark",
    "UTF-8 needs no byte order mark, and several YAML readers stumble over one.",
    "save the file as UTF-8 without a byte order mark",
)
rule("E105", "error", "empty file", "A file without content says nothing.", "begin it with `format: 1`")
rule("E106", "error", "YAML syntax", "The text is not YAML, so that nothing after this place can be understood.")
rule(
    "E107",
    "error",
    "tab in the indentation",
    "YAML allows no tabs there, because their width is a matter of taste.",
    "indent with two spaces a level",
)
rule("E108", "error", "nested too deep", "No specification needs this depth; it is a mistake or an attack.")
rule(
    "E109",
    "error",
    "several documents",
    "A file holds one document; what follows a second `---` would be lost.",
    "split the file and include the parts",
)
rule(
    "E110",
    "error",
    "ambiguous value",
    "YAML readers differ about this word or number: `off` is false to some, `0100` is 64, `60:40` is 3640.",
)
rule("E111", "error", "not a number", "It begins like a number but is none, or does not fit into 64 bits.")
rule(
    "E112",
    "error",
    "key is not text",
    "Keys are text, always: an integer key means something else to every other reader.",
)
rule(
    "E113",
    "error",
    "key given twice",
    "Most YAML readers let the second one win without a word.",
    "delete one of the two, or give it another name",
)
rule(
    "E114",
    "error",
    "anchor or alias",
    "Anchors and aliases hide where a fact stands. Shared facts go into an included file.",
    "write the value out, or quote the text if it is meant literally",
)
rule("E115", "error", "tag", "The format has no tags.", "delete the tag, or quote the text if it is meant literally")
rule(
    "E116",
    "error",
    "merge key",
    "The format has no merge keys; not all YAML readers know them.",
    "share facts with `include`, and differ from them with `change`",
)
rule(
    "E117",
    "error",
    "not a mapping",
    "A file is a mapping of sections to their content.",
    "begin the file with `format: 1`",
)
rule(
    "E118",
    "error",
    "format missing or unknown",
    "The number tells old and new tools apart.",
    "write `format: 1` as the first key",
)
rule("E119", "error", "bad include", "`include` is a list of relative file names.", "write `include: [name.yaml]`")
rule("E120", "error", "include not found", "An include is looked up beside the file, then in the spec library.")
rule("E121", "error", "include cycle", "A file cannot build on itself.", "move what both need into a third file")
rule("E122", "error", "too many errors", "Reading stops where more errors would help nobody.", "mend the first ones")

# ---- E2xx: the shape of sections and elements, and merging ---------------------------------------------------------
rule("E201", "error", "unknown key", "The format does not know this key here: a misprint, or the wrong place.")
rule("E202", "error", "missing key", "Something that the format demands was not said.")
rule("E203", "error", "wrong type", "The value is of another kind than the format expects.")
rule("E204", "error", "unknown word", "Only the words listed are allowed here.")
rule("E205", "error", "wrong spelling", "The text does not have the form that the format demands.")
rule("E206", "error", "number out of bounds", "The number is smaller or larger than it can be.")
rule("E207", "error", "wrong amount", "The text or list is shorter or longer than allowed, or repeats itself.")
rule("E208", "error", "wrong combination", "Keys that exclude each other, or a key without the one it needs.")
rule("E209", "error", "bad key", "The key of a mapping does not have the form that the format demands.")
rule(
    "E210",
    "error",
    "defined twice",
    "Two files, or two places of one, define the same element.",
    "to differ from an included element use `change:`; to replace it add it to `remove:` first",
)
rule("E211", "error", "change of nothing", "`change` names an element or key that no included file defines.")
rule("E212", "error", "removal of nothing", "`remove` names an element that no included file defines.")
rule(
    "E213",
    "error",
    "identity changed",
    "Other elements refer to an element by its identity, so that a change cannot give it a new one.",
    "remove the element and define a new one",
)

# ---- E3xx: names and references -------------------------------------------------------------------------------------
rule(
    "E301",
    "error",
    "value cannot be read",
    "A range, default, pattern, scale or bit number is not written as the format says.",
)
rule("E302", "error", "unknown name", "A name refers to an element that no file of the spec defines.")
rule("E303", "error", "sub-index described twice", "Each sub-index of an object has one description.")
rule("E304", "error", "nothing to repeat for", "A sub-index that repeats for each axis needs a device with axes.")
rule(
    "E305",
    "error",
    "incomplete entry",
    "An entry has a type, an access and, if it can be written, a storage group; its own or its object's.",
)
rule(
    "E306",
    "error",
    "gap in the PDO numbers",
    "The PDOs of an axis count from 1 without holes: their objects lie side by side.",
)
rule(
    "E307", "error", "mapping of a whole object", "A PDO maps entries; an array or record is mapped by its sub-indices."
)
rule("E308", "error", "mode without code", "A mode that CiA 402 does not know needs a code of its own.")
rule("E309", "error", "nothing to build", "A root file describes a device or a vocabulary.")

rule("E310", "error", "sub-indices of a variable", "Only arrays and records have sub-indices.")

# ---- E4xx: meaning --------------------------------------------------------------------------------------------------
rule("E401", "error", "mandatory object missing", "CiA 301 demands 1000h, 1001h and 1018h of every device.")
rule("E402", "error", "index out of the dictionary", "An index has 16 bits, on the last axis too.")
rule("E403", "error", "index taken twice", "Two objects, or two axes whose strides overlap, share an index.")
rule("E404", "error", "object outside every area", "An index must say whether it repeats per axis or stands once.")
rule("E405", "error", "value outside its type", "A named value could never be held by the entry.")
rule("E406", "error", "bit outside its type", "A bit lies above the highest one of the data type.")
rule("E407", "error", "range outside its type", "A range promises values that the data type cannot hold.")
rule("E408", "error", "default outside its type", "A default could never be held by the entry.")
rule("E409", "error", "default not allowed", "A device would refuse its own power-on value.")
rule("E410", "error", "value outside the range", "A named value could never be written.")
rule("E411", "error", "range or bits of no integer", "Only integers have ranges and bits.")
rule("E412", "error", "bit described twice", "Two descriptions claim the same bit.")
rule("E413", "error", "string without length", "Storage and segmented transfers need the largest length.")
rule("E414", "error", "write without effect", "Whoever writes an entry wants to know what that does.")
rule("E415", "error", "constant with a role", "A role is a value that the runtime changes.")
rule("E416", "error", "hidden default missing", "There is no default to hide.")
rule("E417", "error", "mapping against access", "A TPDO reads and an RPDO writes the entry that it maps.")
rule("E418", "error", "role of another scope", "A value per axis cannot live in an object of the whole device.")
rule("E419", "error", "role of another type", "The dictionary and the runtime must agree on the size of a value.")
rule("E420", "error", "role has too few elements", "More entries than the runtime's array has room for.")
rule("E421", "error", "role taken twice", "One value has one place in the dictionary.")
rule("E431", "error", "PDO over 64 bits", "A CAN frame carries 8 bytes.")
rule("E432", "error", "PDO with too many entries", "The device maps fewer entries per PDO.")
rule("E433", "error", "mapping of what is not mappable", "The PDO could never carry this object.")
rule("E441", "error", "number given twice", "Two elements with one code could not be told apart on the bus.")
rule("E442", "error", "unreachable PDS state", "No sequence of transitions leads from power-on to the state.")
rule("E443", "error", "ambiguous PDS states", "A statusword must mean one state.")
rule("E446", "error", "axis in a device without axes", "An emergency cannot name an axis that does not exist.")
rule("E451", "error", "identifiers collide", "Two names become one identifier of a target language.")
rule("E452", "error", "reserved word", "The name is a word of a target language.")
rule("E453", "error", "member given twice", "Two values or bits of one entry have the same name.")
rule("E454", "error", "EDS name given twice", "Programs look objects up by their ParameterName.")
rule("E455", "error", "EDS name too long", "Importers cut or refuse longer names.")
rule("E471", "error", "beyond the C tables", "The packed tables of the C runtime have fixed widths and strides.")
rule("E472", "error", "constants collide in C", "C has one name space for all constants of a header.")

# ---- W5xx: warnings -------------------------------------------------------------------------------------------------
rule(
    "W501",
    "warning",
    "CAN-ID shared by PDOs",
    "Two active PDOs with one CAN-ID are allowed by CiA 301, but rarely meant.",
    "disable one of them (bit 31), or give it another CAN-ID",
)
rule("W502", "warning", "erratum decides nothing", "A path of an erratum names nothing that the device has.")
