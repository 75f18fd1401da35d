"""Mutants of the C runtime, all of them in one library.

Each place in a function where something can be taken away or turned round gets a number, and code that does so when the
global `ods_mutant` is that number. So one compilation makes all mutants, and with 0 the code is what it was.

    if (x) ...           negated, or taken for false
    a && b, a || b       without one of them
    a < b                with the equality, or without; a == b turned round
    c ? a : b            negated
    x = 1; f(x); break;  left out
    ODS_ABORT_X          another code
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from tests.mutants.mutant import Catalogue

HEADER = """\
#ifndef ODS_MUTANT_H
#define ODS_MUTANT_H
extern int ods_mutant;
/* Which places have been passed. */
extern unsigned char ods_mutant_passed[];
#define ODS_M(number) (ods_mutant_passed[number] = 1, ods_mutant == (number))
/* The condition as it is, turned round, or false. */
static inline int ods_m_if(int turned, int never, int condition)
{
    return ODS_M(turned) ? !condition : ODS_M(never) ? 0 : condition;
}
static inline int ods_m_turn(int turned, int condition)
{
    return ODS_M(turned) ? !condition : condition;
}
/* An operand that is left out: `instead` is what does not matter. */
static inline int ods_m_operand(int left_out, int instead, int operand)
{
    return ODS_M(left_out) ? instead : operand;
}
#endif
"""

_TOKEN = re.compile(
    r"""
      (?P<space>\s+ | /\*.*?\*/ | //[^\n]*)
    | (?P<directive>^[ \t]*\#(?:[^\n\\]|\\.|\\\n)*)
    | (?P<text>"(?:[^"\\]|\\.)*" | '(?:[^'\\]|\\.)*')
    | (?P<word>[A-Za-z_0-9]+(?:\.[0-9]+)?)
    | (?P<mark><<=|>>=|\.\.\.|->|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|.)
    """,
    re.VERBOSE | re.DOTALL | re.MULTILINE,
)

_OPEN, _CLOSE = {"(": ")", "[": "]", "{": "}"}, {")", "]", "}"}
_ASSIGNMENTS = {"=", "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=", "<<=", ">>="}
_LOOSER = {"<": ("<=", "||"), ">": (">=", "||"), "<=": ("<", "&& !"), ">=": (">", "&& !")}
_TYPES = re.compile(r"const|static|unsigned|signed|int|char|long|short|void|struct|enum|union|\w+_t")

Tokens = Sequence[str]


def instrument(sources: Sequence[Path], catalogue: Catalogue) -> dict[str, str]:
    """The text of each file with all its mutants in it, by name."""
    return {path.name: _File(path.name, catalogue).rewrite(path.read_text()) for path in sources}


def compiled(preprocessed: str) -> set[int]:
    """The numbers of mutants that are in preprocessed text; others are for other machines."""
    text = preprocessed.partition("ods_m_operand")[2]
    found = re.findall(r"ods_mutant == \((\d+)\)|ods_m_if\((\d+), (\d+),|ods_m_(?:turn|operand)\((\d+),", text)
    return {int(number) for match in found for number in match if number}


class _File:
    def __init__(self, name: str, catalogue: Catalogue) -> None:
        self._name = name
        self._catalogue = catalogue
        self._where = name

    def _add(self, kind: str, what: Tokens | str, how: str = "") -> int:
        text = what if isinstance(what, str) else _text(what)
        return self._catalogue.add(f"C: {kind}", self._where, f"{text.strip()}{' ' if how else ''}{how}")

    def rewrite(self, text: str) -> str:
        """Only bodies of functions are changed."""
        tokens = list(_tokens(text))
        out: list[str] = []
        at = 0
        while at < len(tokens):
            end = _closing(tokens, at) if tokens[at] == "{" else at
            if tokens[at] == "{" and _last(out) == ")":
                self._where = f"{self._name}:{_function_name(out)}"
                out.append(self._block(tokens[at : end + 1]))
            else:
                out += tokens[at : end + 1]
            at = end + 1
        return "".join(out)

    # ---- statements --------------------------------------------------------------------------------------------------

    def _block(self, tokens: Tokens) -> str:
        out = ["{"]
        at = 1
        while at < len(tokens) - 1:
            text, at = self._statement(tokens, at)
            out.append(text)
        return "".join([*out, "}"])

    def _statement(self, tokens: Tokens, at: int) -> tuple[str, int]:
        """The statement that begins at a token, rewritten, and where the next one begins."""
        word = tokens[at]
        if _is_space(word):
            return word, at + 1
        if word == "{":
            end = _closing(tokens, at)
            return self._block(tokens[at : end + 1]), end + 1
        if word in ("if", "for", "while", "switch"):
            return self._headed(tokens, at)
        if word in ("else", "do"):
            text, end = self._statement(tokens, _skip(tokens, at + 1))
            return f"{word} {text}", end
        if word in ("case", "default"):
            end = tokens.index(":", at)
            return "".join(tokens[at : end + 1]), end + 1
        end = _find(tokens, at, ";")
        return self._simple(tokens[at:end]), end + 1

    def _headed(self, tokens: Tokens, at: int) -> tuple[str, int]:
        """`if`, `for`, `while` or `switch` with its head and its body; `else` counts as a statement."""
        begin = _skip(tokens, at + 1)
        end = _closing(tokens, begin)
        head = tokens[begin + 1 : end]
        if tokens[at] == "if":
            turned, never = self._add("if turned", head), self._add("if removed", head)
            inner = f"ods_m_if({turned}, {never}, !!({self._expression(head, is_test=True)}))"
        elif tokens[at] == "for":
            first, condition, last = _split(head, ";")
            inner = f"{''.join(first)};{self._expression(condition, is_test=True)};{''.join(last)}"
        else:
            inner = self._expression(head, is_test=True)
        after = _skip(tokens, end + 1)
        if tokens[after] == ";":  # do ... while
            return f"{tokens[at]} ({inner});", after + 1
        body, end = self._statement(tokens, after)
        return f"{tokens[at]} ({inner}) {body}", end

    def _simple(self, tokens: Tokens) -> str:
        """A statement that ends with a semicolon, which is not among the tokens."""
        words = [token for token in tokens if not _is_space(token)]
        if not words:
            return "".join(tokens) + ";"
        if words[0] == "return":
            return f"return {self._expression(tokens[1:])};"
        if _is_declaration(words):
            return self._declaration(tokens)
        number = self._add("statement removed", tokens)
        return f"{{ if (!ODS_M({number})) {{ {self._expression(tokens)}; }} }}"

    def _declaration(self, tokens: Tokens) -> str:
        if "=" not in tokens or "static" in tokens:
            return "".join(tokens) + ";"
        at = list(tokens).index("=")
        value = tokens[at + 1 :]
        if _first(value) == "{":
            return "".join(tokens) + ";"
        return f"{''.join(tokens[: at + 1])} {self._expression(value)};"

    # ---- expressions -------------------------------------------------------------------------------------------------

    def _expression(self, tokens: Tokens, *, is_test: bool = False) -> str:
        """`is_test` tells that the whole expression can be turned round by whoever holds it."""
        marks = _top_level(tokens)
        if "," in marks:
            return ",".join(self._expression(part) for part in _split(tokens, ","))
        for mark in marks:
            if mark in _ASSIGNMENTS:
                left, right = _split_once(tokens, mark)
                return f"{self._expression(left)}{mark}{self._expression(right)}"
        if "?" in marks:
            condition, rest = _split_once(tokens, "?")
            yes, no = _split_at_colon(rest)
            number = self._add("condition turned", condition)
            test = f"ods_m_turn({number}, !!({self._expression(condition, is_test=True)}))"
            return f"{test} ? {self._expression(yes)} : {self._expression(no)}"
        for mark, instead, kind in (("||", 0, "alternative removed"), ("&&", 1, "check removed")):
            if mark in marks:
                return f" {mark} ".join(self._operand(part, tokens, instead, kind) for part in _split(tokens, mark))
        return self._comparison(tokens, marks, is_test)

    def _operand(self, tokens: Tokens, whole: Tokens, instead: int, kind: str) -> str:
        number = self._add(kind, whole, f"without {_text(tokens)}")
        return f"ods_m_operand({number}, {instead}, !!({self._expression(tokens)}))"

    def _comparison(self, tokens: Tokens, marks: Sequence[str], is_test: bool) -> str:
        for mark in ("==", "!="):
            if mark in marks:
                left, right = _split_once(tokens, mark)
                text = f"{self._expression(left)} {mark} {self._expression(right)}"
                if is_test:
                    return text
                return f"ods_m_turn({self._add('comparison turned', tokens)}, ({text}))"
        for mark, (other, glue) in _LOOSER.items():
            if mark in marks:
                a, b = (self._expression(part) for part in _split_once(tokens, mark))
                number = self._add("limit moved", tokens, f"as {other}")
                ends = f"__typeof__({a}) ods_a = ({a}); __typeof__({b}) ods_b = ({b});"
                return f"({{ {ends} ods_a {mark} ods_b {glue}(ODS_M({number}) && (ods_a == ods_b)); }})"
        return self._operands(tokens)

    def _operands(self, tokens: Tokens) -> str:
        """Names, calls and what stands in brackets."""
        out: list[str] = []
        at = 0
        while at < len(tokens):
            token = tokens[at]
            if token == "sizeof":
                begin = _skip(tokens, at + 1)
                end = _closing(tokens, begin) if tokens[begin] == "(" else begin
                out += tokens[at : end + 1]
                at = end
            elif token in _OPEN:
                end = _closing(tokens, at)
                out += [token, self._expression(tokens[at + 1 : end]), _OPEN[token]]
                at = end
            elif token.startswith("ODS_ABORT_"):
                out.append(f"({token} ^ (ODS_M({self._add('another abort code', token)}) ? 1u : 0u))")
            else:
                out.append(token)
            at += 1
        return "".join(out)


# ---- tokens ----------------------------------------------------------------------------------------------------------


def _tokens(text: str) -> Iterator[str]:
    """All of the text; white space and comments become one token each, directives keep their lines."""
    for match in _TOKEN.finditer(text):
        if match.lastgroup == "directive":
            yield f"\n{match[0]}\n"
        elif match.lastgroup == "space":
            yield "\n" if "\n" in match[0] else " "
        else:
            yield match[0]


def _is_space(token: str) -> bool:
    return not token.strip() or token.lstrip().startswith("#")


def _first(tokens: Tokens) -> str:
    return next((token for token in tokens if not _is_space(token)), "")


def _last(tokens: Tokens) -> str:
    return _first(tokens[::-1])


def _text(tokens: Tokens) -> str:
    return " ".join("".join(token for token in tokens if not token.lstrip().startswith("#")).split())


def _skip(tokens: Tokens, at: int) -> int:
    while _is_space(tokens[at]):
        at += 1
    return at


def _closing(tokens: Tokens, at: int) -> int:
    """Where the bracket ends that opens at a token."""
    depth = 0
    for position in range(at, len(tokens)):
        depth += (tokens[position] in _OPEN) - (tokens[position] in _CLOSE)
        if not depth:
            return position
    raise ValueError(f"{tokens[at]} is not closed")


def _levels(tokens: Tokens) -> Iterator[tuple[str, int]]:
    """Each token with the number of brackets that it stands in."""
    depth = 0
    for token in tokens:
        depth -= token in _CLOSE
        yield token, depth
        depth += token in _OPEN


def _top_level(tokens: Tokens) -> list[str]:
    return [token for token, depth in _levels(tokens) if not depth]


def _find(tokens: Tokens, at: int, mark: str) -> int:
    return at + next(n for n, (token, depth) in enumerate(_levels(tokens[at:])) if token == mark and not depth)


def _split(tokens: Tokens, mark: str) -> list[Tokens]:
    parts: list[list[str]] = [[]]
    for token, depth in _levels(tokens):
        if token == mark and not depth:
            parts.append([])
        else:
            parts[-1].append(token)
    return list(parts)


def _split_once(tokens: Tokens, mark: str) -> tuple[Tokens, Tokens]:
    at = _find(tokens, 0, mark)
    return tokens[:at], tokens[at + 1 :]


def _split_at_colon(tokens: Tokens) -> tuple[Tokens, Tokens]:
    """The two branches of a conditional expression; the first one may hold another."""
    waiting = 1
    for at, (token, depth) in enumerate(_levels(tokens)):
        if not depth:
            waiting += (token == "?") - (token == ":")
            if not waiting:
                return tokens[:at], tokens[at + 1 :]
    raise ValueError("a conditional expression without its second branch")


def _function_name(before: Tokens) -> str:
    """The name in front of the brackets that end here."""
    words = [token for token in before if not _is_space(token)]
    depth = 0
    for at in range(len(words) - 1, -1, -1):
        depth += (words[at] in _CLOSE) - (words[at] in _OPEN)
        if not depth:
            return words[at - 1]
    raise ValueError("no function")


def _is_declaration(words: Sequence[str]) -> bool:
    return bool(_TYPES.fullmatch(words[0])) and len(words) > 1 and (words[1] == "*" or words[1][0].isalpha())
