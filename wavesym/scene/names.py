"""Names that can be the prefix of what is generated."""

from __future__ import annotations

import keyword
import re
from typing import Annotated

from pydantic import PlainValidator

from wavesym.fields.table import refusal, show

# C99 tells no more than 63 characters of a name apart.
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,62}")

_C = """auto break case char const continue default do double else enum extern float for goto if inline int long
register restrict return short signed sizeof static struct switch typedef union unsigned void volatile while
alignas alignof bool constexpr false nullptr static_assert thread_local true typeof typeof_unqual"""
_CPP = """and and_eq asm bitand bitor catch char16_t char32_t char8_t class co_await co_return co_yield compl concept
const_cast consteval constinit contract_assert decltype delete dynamic_cast explicit export friend mutable namespace
new noexcept not not_eq operator or or_eq private protected public reinterpret_cast requires static_cast template this
throw try typeid typename using virtual wchar_t xor xor_eq"""
# the soft keywords by name: which they are depends on the Python that runs
_KEYWORDS = frozenset((*_C.split(), *_CPP.split(), *keyword.kwlist, "case", "match", "type"))
_IMPORTED = "numpy"  # by NAME.py, which must not import itself


def _name(value: object) -> str:
    if not isinstance(value, str) or not _NAME.fullmatch(value):
        raise refusal(
            f"{show(value)} is not an identifier; write at most 63 ASCII letters, digits and _, a letter first"
        )
    if value in _KEYWORDS:
        raise refusal(f"{show(value)} is a keyword of C, C++ or Python; write another name")
    if value == _IMPORTED:
        raise refusal(f"{show(value)} is a module that NAME.py imports; write another name")
    return value


Name = Annotated[str, PlainValidator(_name)]
