"""How many bytes generated C takes at most, read from its own text: its structs, and what its functions put on a stack.

The text is ours: what is declared stands on lines of its own, and lengths are sums and products of constants. Numbers
are those of machines of 64 bits, vectors as wide as they get.
"""

from __future__ import annotations

import ast
import operator
import re
from collections.abc import Iterator
from math import prod

_COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
_CONSTANTS = re.compile(r"enum \{(.*?)\}", re.DOTALL)
_STRUCT = re.compile(r"^(?:typedef )?struct ?(\w*) \{$(.*?)^\} ?(\w*);", re.DOTALL | re.MULTILINE)
_STATEMENT = re.compile(r"^ +(?:static |const )*(\w+) ([^;]*);", re.MULTILINE)
_GIVEN = re.compile(r"= (?:\{[^}]*\}|[^,]*)")
_DECLARED = re.compile(r"(?:^|,) *(\*?)\w+((?:\[[^\]]*\])*) *(?=,|$)")
_CHOSEN = re.compile(r"(.*?)\?(.*?):(.*)")
_OPERATORS = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.floordiv}
_POINTER = (8, 8)
_VECTOR = 64
_FRAMES = 128
"""Numbers: so much is left for registers that are kept, what compilers add, and addresses to return to."""

Layout = tuple[int, int]
"""Of a type its size, and of what its address is a multiple."""


class Memory:
    """What was declared in the texts read so far."""

    def __init__(self, name: str, real: int, outputs: int) -> None:
        self._constants = {f"{name.upper()}_OUTPUTS": outputs}
        number, vector = (real, real), (_VECTOR, real)
        numbers = dict.fromkeys(("double", "float", "real", "num"), number)
        vectors = dict.fromkeys(("wide", "slice", "pack", "mask"), vector)
        self._types: dict[str, Layout] = {"int": (4, 4), "size_t": (8, 8), **numbers, **vectors}

    def read(self, text: str) -> None:
        """Constants and structs; where a constant is declared twice the first counts."""
        text = _bare(text)
        for found in sorted((*_CONSTANTS.finditer(text), *_STRUCT.finditer(text)), key=re.Match.start):
            if found.re is _STRUCT:
                name, members, other = found.groups()
                self._types[name or other] = self._layout(members)
                continue
            for name, _, value in (one.partition("=") for one in found[1].split(",")):
                self._constants.setdefault(name.strip(), self._value(value))

    def size(self, struct: str) -> int:
        """In bytes."""
        return self._types[struct][0]

    def stack(self, *texts: str, num: str = "real") -> int:
        """What functions need, at most, whichever of them call one another and none itself; `num` is a type in them."""
        self._types["num"] = self._types[num]
        bare = [_bare(text) for text in texts]
        for name, members, other in (found.groups() for text in bare for found in _STRUCT.finditer(text)):
            self._types[name or other] = self._layout(members)
        bodies = (_STRUCT.sub("", text) for text in bare)
        locals_ = (size * count for body in bodies for (size, _), count in self._arrays(body))
        return _FRAMES * self.size(num) + sum(locals_)

    def _layout(self, members: str) -> Layout:
        end, widest = 0, 1
        for (size, alignment), count in self._arrays(members):
            end = -(-end // alignment) * alignment + size * count
            widest = max(widest, alignment)
        return -(-end // widest) * widest, widest

    def _arrays(self, text: str) -> Iterator[tuple[Layout, int]]:
        """The type of each thing that is declared, and how many there are of it."""
        for kind, declared in _STATEMENT.findall(text):
            for pointer, lengths in _DECLARED.findall(_GIVEN.sub("", declared)) if kind in self._types else ():
                count = prod(map(self._value, re.findall(r"\[(.*?)\]", lengths)))
                yield _POINTER if pointer else self._types[kind], count

    def _value(self, expression: str) -> int:
        """An integer of constants."""
        text = re.sub(r"sizeof\((\w+)\)", lambda of: str(self.size(of[1])), expression)
        text = _CHOSEN.sub(r"(\2) if (\1) else (\3)", text)
        return self._evaluate(ast.parse(text.strip(), mode="eval").body)

    def _evaluate(self, node: ast.expr) -> int:
        match node:
            case ast.Constant(value=int(number)):
                return number
            case ast.Name(id=name):
                return self._constants[name]
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return -self._evaluate(operand)
            case ast.IfExp(test=ast.Compare(left=left, ops=[ast.Lt()], comparators=[right]), body=one, orelse=other):
                return self._evaluate(one if self._evaluate(left) < self._evaluate(right) else other)
            case ast.BinOp(left=left, op=sign, right=right):
                value: int = _OPERATORS[type(sign)](self._evaluate(left), self._evaluate(right))
                return value
        raise ValueError(f"{ast.unparse(node)}: no integer of constants")


def _bare(text: str) -> str:
    """Without comments; what is called OF(name) is called name."""
    return re.sub(r"\bOF\((\w+)\)", r"\1", _COMMENT.sub("", text))
