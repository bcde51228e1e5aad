"""Mutants of a source: each with one small mistake, all other text as it is.

Left alone is what no value and no bound rests on: texts, types, declarations of fields, imports, errors; and what only
estimates a cost, or refuses what costs too much.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from hashlib import sha256
from itertools import accumulate, pairwise

OPPOSITE = {ast.Add: ("+", "-"), ast.Sub: ("-", "+"), ast.Mult: ("*", "/"), ast.Div: ("/", "*")}
BOUNDARY = {ast.Lt: ("<", "<="), ast.LtE: ("<=", "<"), ast.Gt: (">", ">="), ast.GtE: (">=", ">")}
LIKE = {"max": "min", "maximum": "minimum", "upper": "lower", "ceil": "floor"}
LIKE |= {wrong: right for right, wrong in LIKE.items()} | {"not_below": "nearest"}
ATOMS = (ast.Name, ast.Constant, ast.Call, ast.Attribute, ast.Subscript)
COST_LIMITS = re.compile(
    r"_?(MOST|LARGEST|QUICK|MODERATE|FAST|HIGHEST|USUAL|SHORTE|FIRST|BLOCK|WORTH|EXP$|SAMPLES|OVERHEAD|BOUNDING|SETTLED)"
)
COSTS = {"work", "bytes", "state_bytes", "least_bytes", "stored", "operator_count", "beginning", "refuse_many"}
COSTS |= {
    "_bytes",
    "_least",
    "_size",
    "_state",
    "_refuse_long",
    "refuse_long",
    "_first_degree",
    "first_degree",
    "degrees",
    "step_multiplications",
    "step_operations",
    "table_bytes",
    "turning",
}
TEXTS = {"summary", "shortfall", "options", "refuse_unknown", "suitable_spacing"}
TEXTS |= {"check_points"}  # and where a self-test looks

# what in C does not compute: comments, texts, directives, tables and sizes outside of functions
NO_CODE = re.compile(r'/\*[\s\S]*?\*/|"[^"\n]*"|^#.*|^(static const|enum) [^;]*;', re.MULTILINE)
FUNCTION = re.compile(r"^[a-z].*?(\w+)\(", re.MULTILINE)
IN_C = [
    (re.compile(r"(?<=\S )([+-])(?==? )"), lambda sign: ["-" if sign == "+" else "+"]),
    (re.compile(r"(?<= )([<>]=?)(?= )"), lambda sign: [sign[0] if sign[1:] else f"{sign}="]),
    (re.compile(r"( [+-] \w+(\[[\w\[\] *+-]*\])?)(?![\w\[(.])"), lambda term: [""]),
    (re.compile(r"\b(max|min)(?=\()"), lambda name: [LIKE[name]]),
    (re.compile(r"(?<![\w.])(\d+(\.\d+)?)(?![\w.])"), lambda number: numbers(ast.literal_eval(number))),
]


Edit = tuple[int, int, str]  # what is between two places of a text becomes another
Names = tuple[str, str, str, str]


@dataclass(frozen=True)
class Mutant:
    """A source with one mistake: the lines `right` of a function have become `wrong`, all of it is `text`."""

    file: str
    function: str
    right: str
    wrong: str
    text: str

    @property
    def names(self) -> Names:
        """Which mutant it is, as long as these lines stay what they are."""
        return self.file, self.function, self.right, self.wrong

    @property
    def key(self) -> str:
        """The same in short."""
        return self.lot("")[:8]

    def lot(self, seed: object) -> str:
        """What orders mutants at random."""
        return sha256("\n".join([*self.names, str(seed)]).encode()).hexdigest()

    def __str__(self) -> str:
        return f"`{self.key}` {self.file}: {self.function}\n\n    - {self.right}\n    + {self.wrong}\n"


def mutants(file: str, source: str) -> Iterator[list[Mutant]]:
    """The mutants of each place of a source."""
    for function, edits in _Python(source).places() if file.endswith(".py") else _in_c(source):
        made = []
        for start, end, other in edits:
            low, high = source.rfind("\n", 0, start) + 1, source.index("\n", end)
            right, wrong = source[low:high], source[low:start] + other + source[end:high]
            text = source[:low] + wrong + source[high:]
            made.append(Mutant(file, function, " ".join(right.split()), " ".join(wrong.split()), text))
        if made:
            yield made


def numbers(value: float) -> list[str]:
    """Other numbers in place of one: twice, half and a quarter of it, and its neighbours if it is whole."""
    others = [2 * value, value / 2, value / 4]
    if isinstance(value, int):
        others = [value + 1, value - 1, 2 * value, *(value // part for part in (2, 4) if value % part == 0)]
    return [repr(other) for other in dict.fromkeys(others) if other != value]


class _Python:
    def __init__(self, source: str) -> None:
        if not source.isascii():
            raise ValueError("a column of the syntax tree counts bytes")
        self._source = source
        self._starts = [0, *accumulate(len(line) for line in source.splitlines(keepends=True))]
        self._tree = ast.parse(source)
        self._known = {name for node in self._tree.body for name in _defined(node)} | {"max", "min"}

    def places(self) -> Iterator[tuple[str, list[Edit]]]:
        """The name of the function, and the edits, of each node that has some."""
        stack: list[tuple[ast.AST, str]] = [(self._tree, "")]
        while stack:
            node, function = stack.pop()
            if isinstance(node, ast.FunctionDef | ast.ClassDef):
                function = f"{function}.{node.name}".lstrip(".")
            if edits := list(self._edits(node)):
                yield function, edits
            stack += [(child, function) for child in _children(node)][::-1]

    def _edits(self, node: ast.AST) -> Iterator[Edit]:
        match node:
            case ast.BinOp(left, op, right) if type(op) in OPPOSITE:
                yield self._between(left, right, *OPPOSITE[type(op)])
                if not isinstance(op, ast.Div):
                    yield self._replaced(node, self._text(left))
                    yield self._replaced(node, ("-" if isinstance(op, ast.Sub) else "") + self._text(right))
            case ast.AugAssign(target, op, value) if type(op) in OPPOSITE:
                yield self._between(target, value, *OPPOSITE[type(op)])
            case ast.UnaryOp(ast.USub(), operand):
                yield self._replaced(node, self._text(operand))
            case ast.Constant(value) if type(value) in (int, float):
                yield from (self._replaced(node, f"({text})" if text[0] == "-" else text) for text in numbers(value))
            case ast.Compare(left, [op], [right]) if type(op) in BOUNDARY:
                yield self._between(left, right, *BOUNDARY[type(op)])
            case ast.BoolOp(op, values):
                signs = ("and", "or") if isinstance(op, ast.And) else ("or", "and")
                yield from (self._between(one, two, *signs) for one, two in pairwise(values))
            case ast.Call(ast.Name("abs") | ast.Attribute(_, "abs"), [argument]):
                yield self._replaced(node, self._text(argument))
            case ast.Call(ast.Attribute(value, "max" | "min"), [argument]) if self._text(value) != "np":
                yield from (self._replaced(node, self._text(kept)) for kept in (value, argument))
            case ast.Call(ast.Name("max" | "min") | ast.Attribute(_, "maximum" | "minimum"), [one, two], []):
                if not isinstance(one, ast.Starred):
                    yield from (self._replaced(node, self._text(kept)) for kept in (one, two))
            case ast.Name(name) if LIKE.get(name) in self._known:
                yield self._replaced(node, LIKE[name])
            case ast.alias(name) if name in LIKE and LIKE[name] not in self._known:
                yield self._replaced(node, f"{LIKE[name]} as {name}")
            case ast.Attribute(value, name) if name in LIKE:
                yield self._replaced(node, f"{self._text(value)}.{LIKE[name]}")
            case ast.If(test) | ast.While(test) | ast.IfExp(test) if not _refusal(node):
                yield self._replaced(test, f"not {self._text(test)}")
            case ast.comprehension(ifs=[test]):
                yield self._replaced(test, f"not {self._text(test)}")

    def _span(self, node: ast.AST) -> tuple[int, int]:
        low, high = self._starts[node.lineno - 1], self._starts[node.end_lineno - 1]
        return low + node.col_offset, high + node.end_col_offset

    def _text(self, node: ast.AST) -> str:
        low, high = self._span(node)
        text = self._source[low:high]
        return text if isinstance(node, ATOMS) else f"({text})"

    def _replaced(self, node: ast.AST, text: str) -> Edit:
        return *self._span(node), text

    def _between(self, left: ast.AST, right: ast.AST, sign: str, other: str) -> Edit:
        start = self._source.index(sign, self._span(left)[1], self._span(right)[0])
        return start, start + len(sign), other


def _defined(node: ast.AST) -> list[str]:
    if isinstance(node, ast.ImportFrom):
        return [alias.name for alias in node.names]
    return [node.name] if isinstance(node, ast.FunctionDef) else []


def _refusal(node: ast.AST) -> bool:
    match node:
        case ast.If(_, [ast.Raise(ast.Call(ast.Name("CostError")))]):
            return True
    return False


def _children(node: ast.AST) -> Iterator[ast.AST]:
    match node:
        case ast.Raise() | ast.JoinedStr() | ast.Import() | ast.alias() | ast.arguments():
            return
        case ast.If(orelse=rest) if _refusal(node):
            yield from rest
            return
        case ast.FunctionDef(name, _, body):
            yield from () if name in COSTS | TEXTS else body
            return
        case ast.ClassDef(body=body):
            yield from (child for child in body if not isinstance(child, ast.AnnAssign))
            return
        case ast.AnnAssign(value=value):
            yield from [value] if value else []
            return
        case ast.Assign([ast.Name(name)]) if COST_LIMITS.match(name):
            return
    yield from ast.iter_child_nodes(node)


def _in_c(source: str) -> Iterator[tuple[str, list[Edit]]]:
    """The same of C, sign by sign."""
    code = NO_CODE.sub(lambda found: re.sub(r"\S", " ", found[0]), source)
    functions = [(found.start(), found[1]) for found in FUNCTION.finditer(code)]
    for pattern, others in IN_C:
        for place in pattern.finditer(code):
            function = max((each for each in functions if each[0] <= place.start()), default=(0, ""))[1]
            yield function, [(*place.span(), other) for other in others(place[1])]
