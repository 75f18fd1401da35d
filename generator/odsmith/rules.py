"""The registry of rules: every finding that odsmith can report, what it means and how to mend it.

`check`, `lint`, `coverage`, `import` and `diff` share it, and the documentation prints it. The first digit tells the
phase: E1xx reading a file, E2xx its shape, E3xx names and references, E4xx meaning, W5xx warnings, E7xx and W7xx the
model beside the manual. Findings in EDS and DCF files begin with L: L1xx the text, L2xx its sections, L3xx what it says
of itself and the device, L4xx objects, L5xx PDOs, L6xx axes.
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
rule("E422", "error", "NMT state of another value", "Only a choice of what an error does leads to an NMT state.")
rule("E423", "error", "one choice, two NMT states", "A choice of error behaviour means the same for every error.")
rule(
    "E424", "error", "value that no driver takes", "A motor driver is told a 32 bit number and the index of its object."
)
rule("E425", "error", "role without its effect", "Writing a parameter of a PDO has to configure the PDO.")
rule("E431", "error", "PDO over 64 bits", "A CAN frame carries 8 bytes.")
rule("E432", "error", "PDO with too many entries", "The device maps fewer entries per PDO.")
rule("E433", "error", "mapping of what is not mappable", "The PDO could never carry this object.")
rule("E434", "error", "set-up in a PDO", "A PDO does not say which entry it writes, but set-up depends on it.")
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

# ---- E7xx: coverage, the model held against a manual ----------------------------------------------------------------
rule(
    "E701",
    "error",
    "table not accounted for",
    "A table of the manual is modelled, or listed with the reason why it holds no fact about the device.",
    "let the `source` of an element name it, or add it to `without_facts` of the manual",
)
rule("E702", "error", "source not in the manual", "A source names a section or table that the manual does not have.")
rule(
    "E703",
    "error",
    "model differs from the manual",
    "Where the model says something else than a table of the manual, an erratum says why.",
    "correct the model, or write an erratum that names the element in `paths` and the table in `source`",
)
rule(
    "E704",
    "error",
    "contents differ from the manual",
    "The account is worth no more than the list of sections and tables that it goes by.",
    "correct `manuals` after the text of the manual",
)

# ---- L1xx: the text of EDS and DCF files ----------------------------------------------------------------------------
rule("L100", "error", "not an EDS", "The file has none of the sections that CiA 306 describes.", "name an EDS or a DCF")
rule(
    "L101",
    "error",
    "byte order mark",
    "Readers compare the first bytes with `[FileInfo]` and refuse a file that begins with anything else.",
    "save the file as ASCII, without a byte order mark",
)
rule(
    "L102",
    "warning",
    "something before FileInfo",
    "Some readers tell an EDS by its first bytes; one takes a file that begins with a comment for JSON.",
    "delete the lines before `[FileInfo]`, or move them into `[Comments]`",
)
rule(
    "L103",
    "error",
    "character outside ASCII",
    "CiA 306 allows printable ASCII. What other bytes mean depends on the machine that reads them.",
    "write it in ASCII",
)
rule(
    "L104",
    "warning",
    "lines without CRLF",
    "CiA 306 ends each line in CR LF; tools on Windows see one long line otherwise.",
    "convert the line ends, and keep the version control from changing them",
)
rule("L105", "warning", "last line not ended", "Readers that look for the end of a line lose the last key.")
rule(
    "L106",
    "error",
    "line too long",
    "CiA 306 allows 255 characters a line; a reader with a buffer of that size reads the rest as another line.",
    "shorten the value",
)
rule(
    "L107",
    "warning",
    "comment outside Comments",
    "CiA 306 keeps comments in `[Comments]`; not every reader skips a line that begins with `;`.",
    "move it into `[Comments]`",
)
rule("L108", "error", "line without meaning", "A line is a section, a key with a value, or blank.")
rule("L109", "warning", "stray blanks", "Not every reader strips the blanks around sections, keys and values.")
rule("L110", "error", "section not closed", "The name of a section stands alone on its line, in brackets.")
rule(
    "L111",
    "error",
    "comment sign in a value",
    "A blank with `;` or `#` behind it begins a comment for some readers: they lose the rest of the value.",
    "write it without the sign",
)
rule(
    "L112",
    "warning",
    "second equals sign",
    "Readers need not agree on which of the two divides the line.",
    "write the value without it",
)
rule("L113", "error", "key given twice", "One reader takes the first, another the last, a third refuses the file.")
rule("L114", "error", "section given twice", "One reader takes the first, another the last, a third refuses the file.")
rule(
    "L115",
    "error",
    "number without digits",
    "A key without a value is no number, and some readers fail on it.",
    "give the number, or leave the key out",
)
rule(
    "L116",
    "error",
    "leading zeros",
    "A decimal number with a leading zero is octal to some readers and refused by others.",
    "write it without the zeros, or with `0x`",
)
rule("L117", "error", "not a number", "A number is decimal, or hexadecimal with `0x`.")
rule("L118", "error", "neither 0 nor 1", "The key answers a question with yes or no.")

# ---- L2xx: the sections of EDS and DCF files ------------------------------------------------------------------------
rule(
    "L201",
    "error",
    "section spelt otherwise",
    "Some readers compare the names of sections letter by letter, and a blank in one made a reader say that the file "
    "is no EDS.",
)
rule(
    "L202",
    "warning",
    "unknown section",
    "CiA 306 does not know the section: a misprint, or an extension that strict readers refuse.",
)
rule("L203", "error", "section missing", "Readers expect it, and some fail without it.")
rule(
    "L204",
    "warning",
    "section out of order",
    "The order that every reader takes is FileInfo, DeviceInfo, DummyUsage, Comments, the lists of mandatory, optional "
    "and manufacturer's objects, then the objects, ascending.",
)
rule(
    "L205",
    "warning",
    "unknown key",
    "CiA 306 does not know the key: a misprint, or an extension that strict readers refuse.",
    "delete the line, or correct the name",
)
rule("L206", "note", "key spelt otherwise", "Case does not count, but a strict reader may think otherwise.")
rule(
    "L207",
    "error",
    "dummy missing",
    "The keys Dummy0001 to Dummy0007 say which types may fill gaps in a PDO; a widespread reader fails without them.",
)
rule(
    "L208", "warning", "comments miscounted", "`Lines` counts the lines of `[Comments]`, which are called Line1, Line2."
)
rule("L211", "error", "list miscounted", "Readers read as many objects as `SupportedObjects` announces, and no more.")
rule("L212", "warning", "count not decimal", "Strict readers take `SupportedObjects` as a decimal number.")
rule(
    "L213",
    "error",
    "list misnumbered",
    "The items of a list are numbered from 1 without holes; readers look for each number.",
    "number the items anew",
)
rule("L214", "warning", "index spelt otherwise", "Every reader takes `0x1000`; other spellings are a matter of luck.")
rule(
    "L215",
    "error",
    "object listed twice",
    "An object is in one list, once.",
    "delete one of the two and renumber the list",
)
rule(
    "L216",
    "error",
    "object in the wrong list",
    "1000h, 1001h and 1018h are mandatory, 2000h to 5FFFh are the manufacturer's, all others are optional (CiA 301).",
    "move it, and renumber both lists",
)
rule(
    "L217",
    "error",
    "object without a section",
    "A list promises an object that the file does not describe.",
    "describe the object, or take it from the list",
)
rule("L218", "error", "object not listed", "Readers go by the lists: they never see the object.")
rule("L219", "error", "mandatory object missing", "CiA 301 demands 1000h, 1001h and 1018h of every device.")

# ---- L3xx: what a file says of itself and of the device -------------------------------------------------------------
rule("L301", "warning", "key missing", "Tools show or use it, and some fail without it.")
rule(
    "L302",
    "warning",
    "other file name",
    "Tools store the file under the name that it gives, or warn.",
    "rename the file, or correct the name",
)
rule("L303", "error", "version too large", "FileVersion and FileRevision are UNSIGNED8 (CiA 306).")
rule("L304", "warning", "other EDS version", "4.0 is the version of the format that tools know.")
rule("L305", "warning", "not a time", "Times are written `hh:mmAM` or `hh:mmPM`.")
rule("L306", "warning", "not a date", "Dates are written `mm-dd-yyyy`.")
rule(
    "L307",
    "error",
    "bit rate without a key",
    "CiA 306 has keys for 10, 20, 50, 125, 250, 500, 800 and 1000 kbit/s; strict readers refuse any other.",
    "say it in `[Comments]`",
)
rule(
    "L309",
    "error",
    "PDOs miscounted",
    "Masters reserve as many PDOs as `NrOfRXPDO` and `NrOfTXPDO` announce: they are the number of communication "
    "parameter objects.",
)
rule(
    "L310",
    "error",
    "two identities",
    "A master compares the identity object 1018h with the device; a file that says it in two ways fits no device.",
    "correct the one that is wrong",
)
rule(
    "L311",
    "warning",
    "identity without value",
    "Masters compare the defaults of 1018h with the device to find the right file. Only a serial number has none, for "
    "it differs between devices.",
)
rule(
    "L312",
    "warning",
    "wrong granularity",
    "The granularity of a mapping in bits: 8 for bytes. 0 means fixed: tools then do not offer to change the mapping.",
)
rule("L321", "error", "node-ID unreadable", "The node-ID of a DCF is a decimal number from 1 to 127.")
rule(
    "L322",
    "warning",
    "parameter value in an EDS",
    "An EDS describes a type of devices. The value of one device belongs into a DCF.",
    "delete the line, or add [DeviceComissioning] and make it a DCF",
)
rule(
    "L323",
    "error",
    "node-ID not resolved",
    "A DCF is about one device: its node-ID is known, and readers download the value as it stands.",
    "write the value for this node-ID",
)
rule("L324", "note", "value is the default", "A ParameterValue that changes nothing costs a download at every start.")

# ---- L4xx: objects and values of EDS and DCF files ------------------------------------------------------------------
rule("L401", "error", "object incomplete", "Every object has a name, every value a data type and an access.")
rule(
    "L402", "error", "unknown object type", "Objects are variables (0x7), arrays (0x8), records (0x9) or domains (0x2)."
)
rule("L403", "error", "unknown data type", "The data types of a dictionary are those of CiA 301, table 44.")
rule("L404", "error", "unknown access", "The access is ro, wo, rw, rwr, rww or const, in lower case.")
rule("L405", "warning", "misplaced key", "Values have a type, an access and a default; arrays and records have values.")
rule("L406", "error", "sub-indices of a variable", "Only arrays and records have sub-indices.", "set ObjectType to 0x9")
rule(
    "L407",
    "error",
    "sub-indices miscounted",
    "SubNumber counts the sections of the sub-indices, sub-index 0 included; readers look for as many.",
)
rule(
    "L408",
    "error",
    "wrong sub-index 0",
    "Sub-index 0 of an array or record is UNSIGNED8 and read-only, but where it counts mapped objects or errors "
    "(CiA 301).",
)
rule("L409", "error", "wrong highest sub-index", "The value of sub-index 0 is the highest sub-index (CiA 301, 7.4.5).")
rule(
    "L410",
    "error",
    "compact sub-indices",
    "Many readers do not know CompactSubObj, and see an object without sub-indices.",
    "write a section for each sub-index",
)
rule("L411", "error", "sub-index without its object", "Readers find a sub-index through its object.")
rule(
    "L412",
    "warning",
    "name given twice",
    "Programs look objects up by their ParameterName, and find only one of the two.",
    "add what tells them apart, such as the number of the axis",
)
rule(
    "L413",
    "note",
    "long name of a PDO",
    "The names of PDO parameters become names of frames in other formats, which allow 32 characters.",
)
rule(
    "L414",
    "warning",
    "wrong ObjFlags",
    "Bit 0 keeps tools from writing a command when they scan a device or download a configuration. A parameter with it "
    "is never written.",
)
rule(
    "L415",
    "warning",
    "wrong device type",
    "Masters choose their driver by the profile number in the low word of 1000h. Of a drive with several axes they "
    "count the axes by 67FFh and its like at a distance of 800h (CiA 402).",
)
rule(
    "L421",
    "error",
    "negative number as unsigned",
    "A negative value in hexadecimal is positive, and too large, to most readers.",
    "write signed types in decimal",
)
rule(
    "L422",
    "note",
    "signed number in hexadecimal",
    "Signed types are written in decimal, so that no reader has to guess about the highest bit.",
)
rule("L423", "error", "value outside its type", "The data type cannot hold the value.")
rule("L424", "error", "limits reversed", "The lower limit is above the higher one, so that no value is allowed.")
rule("L425", "error", "default outside the limits", "A tool that downloads defaults would be refused by the device.")
rule(
    "L426",
    "warning",
    "limits missing",
    "No device allows every value here (CiA 301, CiA 402), but a tool that knows no limits writes any.",
    "add LowLimit and HighLimit",
)
rule("L427", "error", "node-ID spelt otherwise", "Strict readers know `$NODEID+0x200` and no other form.")
rule(
    "L428",
    "warning",
    "CAN-ID without node-ID",
    "Two devices of this type would send with the same CAN-ID.",
    "write it as `$NODEID+0x...`",
)
rule(
    "L429",
    "warning",
    "default of a command",
    "Some tools write the default of every writable object: that of a command runs it.",
)
rule(
    "L430",
    "warning",
    "default of node-ID or bit rate",
    "Some tools write the default of every writable object, and would give each device the same node-ID.",
)
rule(
    "L431",
    "warning",
    "default of text",
    "Readers do not agree on how a text, octets or a floating point number is written: one fails on a default without "
    "quotes, another keeps the quotes.",
)
rule("L432", "error", "limits of text", "Only numbers have limits.")

# ---- L5xx: PDOs of EDS and DCF files --------------------------------------------------------------------------------
rule("L501", "error", "half a PDO", "A PDO has a communication and a mapping parameter object, at the same distance.")
rule("L502", "warning", "mapping without default", "Masters take the mapping at power-on from the file.")
rule("L503", "error", "mapping of what does not exist", "The file describes no such object or sub-index.")
rule(
    "L504", "error", "mapping of what is not mappable", "A PDO carries objects with PDOMapping=1, and allowed dummies."
)
rule(
    "L505", "error", "wrong length in a mapping", "The low byte of a mapping entry is the length of the object in bits."
)
rule("L506", "error", "PDO over 64 bits", "A CAN frame carries 8 bytes.", "map fewer objects")
rule("L507", "error", "mapping against access", "An RPDO writes what it carries, a TPDO reads it.")
rule("L508", "error", "mapping with a hole", "Sub-index 0 counts the objects in force, which come first.")
rule(
    "L509",
    "warning",
    "CAN-ID shared by PDOs",
    "Two active PDOs with one CAN-ID are allowed by CiA 301, but rarely meant.",
    "disable one of them (bit 31), or give it another CAN-ID",
)
rule(
    "L510",
    "warning",
    "PDO access without mapping",
    "rww and rwr say how a PDO carries the object.",
    "set PDOMapping to 1, or the access to rw",
)
rule("L511", "error", "reserved transmission type", "CiA 301 gives the values between 240 and 252 no meaning.")

# ---- L6xx: axes of EDS and DCF files --------------------------------------------------------------------------------
rule(
    "L601",
    "warning",
    "axes differ",
    "All axes have the same objects, so that what works with one works with all. A difference is mostly a mistake in "
    "one of them.",
    "make the axes alike",
)
rule("L602", "warning", "names of axes differ", "Programs build the name of an object from the number of its axis.")
rule("L603", "note", "names of sub-indices differ", "A sub-index has one name on every axis.")
rule("L604", "warning", "object missing on an axis", "Other axes have it, and programs expect it on each.")

# ---- W5xx: warnings -------------------------------------------------------------------------------------------------
rule(
    "W501",
    "warning",
    "CAN-ID shared by PDOs",
    "Two active PDOs with one CAN-ID are allowed by CiA 301, but rarely meant.",
    "disable one of them (bit 31), or give it another CAN-ID",
)
rule("W502", "warning", "erratum decides nothing", "A path of an erratum names nothing that the device has.")

# ---- W7xx: warnings of coverage -------------------------------------------------------------------------------------
rule(
    "W701",
    "warning",
    "modelled though without facts",
    "An element cites a section or table that is listed as holding no fact about the device.",
    "take it off the list, or correct the source",
)
rule(
    "W702",
    "warning",
    "section not accounted for",
    "Nothing cites the section, and it is not listed as holding no fact about the device.",
    "let the `source` of an element name it, or add it to `without_facts` of the manual",
)
rule("W703", "warning", "element without source", "Whoever doubts a fact wants to know who says so.", "add a `source`")
rule(
    "W704",
    "warning",
    "table not compared",
    "The heading of the table is none that a reader knows, or its cells have lost the tabs between them.",
    "compare it by eye",
)
