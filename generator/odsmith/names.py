"""Identifiers for the target languages, all made here.

Names in a spec are snake_case. Two names that become one identifier, or a name that is a word of the target
language, are errors of the spec (`check`), never repaired silently.
"""

from __future__ import annotations

import keyword
import re

# Words of C, of C++ (a header may be included there) and of the C library.
_C_WORDS = """
auto break case char const continue default do double else enum extern float for goto if inline int long register
restrict return short signed sizeof static struct switch typedef union unsigned void volatile while asm bool true false
near far interrupt class namespace private protected public template this typename using virtual new delete operator
throw try catch friend explicit export mutable and or not xor bitand bitor compl and_eq or_eq xor_eq not_eq alignas
alignof char8_t char16_t char32_t co_await co_return co_yield concept consteval constexpr constinit const_cast decltype
dynamic_cast noexcept nullptr reinterpret_cast requires static_assert static_cast thread_local typeid wchar_t typeof
linux unix errno stdin stdout stderr NULL offsetof
"""
_RESERVED_IN_C = frozenset(re.findall(r"\w+", _C_WORDS))


def constant(*parts: str) -> str:
    """UPPER_SNAKE_CASE of the parts, for C macros and enumerators and Python constants."""
    return "_".join(part.upper() for part in parts if part)


def class_name(name: str) -> str:
    """CamelCase of a snake_case name, for Python classes."""
    return "".join(word[:1].upper() + word[1:] for word in name.split("_"))


def reserved_in_c(name: str) -> bool:
    """True for a C or C++ keyword, or a name that the C library takes."""
    return name in _RESERVED_IN_C


def reserved_in_python(name: str) -> bool:
    """True for a hard keyword of Python (soft ones such as `match` may name things)."""
    return keyword.iskeyword(name)
