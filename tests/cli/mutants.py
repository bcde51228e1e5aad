"""Good scenes spoilt at random: keys, types, numbers, structure, lines and bytes; the same mutant for the same seed."""

from __future__ import annotations

import copy
import random
import tomllib
from collections.abc import Callable, Iterator
from importlib.resources import files
from typing import Any

from wavesym.scene import builtin_names


class Raw(str):
    """Text that stands in TOML as it is."""

    __slots__ = ()


SOURCES = {name: (files("wavesym.scene") / "builtin" / f"{name}.toml").read_text("utf-8") for name in builtin_names()}

NUMBERS = [
    *("0", "-0.0", "1", "-1", "2", "3", "0.5", "1e-9", "1.0000000001", "7.25", "1e5", "1e9", "1e39", "1e-46", "5e-324"),
    *("1e300", "1e-300", "1e301", "1e999999999", "-1e999999999", "1e-999999999", "nan", "-inf", "inf", "0x10", "0b1"),
    *(
        "1_0",
        "1_000",
        "1e2",
        "1e3",
        "9" * 90,
        "9" * 4000,
        "9" * 5000,
        "0." + "3" * 90,
        "0." + "3" * 500,
        "18446744073709551616",
    ),
    *('"1/3"', '"1/0"', '"-7/2"', '"1/99999999999999999999999"', '"2e1"', '"0x1p3"', '" 1"', '"1/-2"', '"\u0661"'),
]
TEXTS = [
    *(
        "",
        "x",
        "int",
        "lambda",
        "../x",
        "/etc/passwd",
        "a\0b",
        "a\nb",
        "a\r\nb",
        "\u00e9",
        "\u202e",
        "\U0001f600",
        "1+",
    ),
    *("0-", "1/2+", "-", "+", "drive", "building", "collision", "force", "ground", "numpy", "x" * 64, "x" * 10**5),
    *(
        "{{7*7}}",
        "{% include 'c/header.h.j2' %}",
        "__import__('os').abort()",
        "$(touch pwned)",
        "*/ #include",
        "\\input",
    ),
]
KEYS = [
    "",
    "name",
    "m",
    "kappa",
    "load",
    "self",
    "__class__",
    "model_config",
    "a b",
    "\u00fc",
    "type",
    "x" * 3000,
    "until",
]
HUGE = 10**5


def mutant(seed: int) -> bytes:
    """A file that was a scene; now and then it still is one."""
    rng = random.Random(seed)
    source = SOURCES[rng.choice(list(SOURCES))]
    if rng.random() < 0.25:
        return _in_text(source, rng)
    tree = tomllib.loads(source, parse_float=Raw)
    for _ in range(rng.choice([1, 1, 1, 2, 3])):
        rng.choice(TREE)(tree, rng)
    return toml(tree).encode("utf-8", "surrogatepass")


def toml(tree: dict[str, Any]) -> str:
    """A tree as TOML, each key of the first level a line."""
    return "".join(f"{_key(key)} = {_inline(value)}\n" for key, value in tree.items())


def _inline(value: Any) -> str:
    match value:
        case Raw():
            return value
        case bool():
            return str(value).lower()
        case str():
            return basic_string(value)
        case dict():
            return "{" + ", ".join(f"{_key(key)} = {_inline(item)}" for key, item in value.items()) + "}"
        case list():
            return "[" + ", ".join(map(_inline, value)) + "]"
    return str(value)


def _key(key: str) -> str:
    return key if key.isascii() and key.isidentifier() else basic_string(key)


def basic_string(value: str) -> str:
    """Text as TOML's basic string."""
    escaped = (c if c.isprintable() and c not in '"\\' else f"\\U{ord(c):08X}" for c in value)
    return '"' + "".join(escaped) + '"'


def _places(node: Any) -> Iterator[tuple[Any, Any]]:
    """Every container with a key or index in it."""
    for key in list(node) if isinstance(node, dict) else range(len(node)):
        yield node, key
        if isinstance(node[key], dict | list):
            yield from _places(node[key])


def _place(tree: Any, rng: random.Random) -> tuple[Any, Any]:
    return rng.choice([*_places(tree), ({"x": tree}, "x")])


def _value(rng: random.Random) -> Any:
    return rng.choice(
        [
            lambda: Raw(rng.choice(NUMBERS)),
            lambda: rng.choice(TEXTS),
            lambda: rng.choice([True, [], {}, [[]], [{}], {"a": {}}, Raw("1979-05-27"), Raw("[" * 500 + "]" * 500)]),
            lambda: [Raw(rng.choice(NUMBERS)) for _ in range(rng.choice([1, 2, 3, 100]))],
            lambda: [Raw(str(k)) for k in range(rng.choice([10, 1000, HUGE]) if rng.random() < 0.1 else 5)],
        ]
    )()


def _replaced(tree: Any, rng: random.Random) -> None:
    node, key = _place(tree, rng)
    node[key] = _value(rng)


def _number(tree: Any, rng: random.Random) -> None:
    """Another number where there is one."""
    numbers = [(n, k) for n, k in _places(tree) if isinstance(n[k], int | Raw) or (isinstance(n, list) and n[k] != {})]
    if numbers:
        node, key = rng.choice(numbers)
        node[key] = Raw(rng.choice(NUMBERS))


def _removed(tree: Any, rng: random.Random) -> None:
    node, key = _place(tree, rng)
    del node[key]


def _added(tree: Any, rng: random.Random) -> None:
    containers = [tree, *(n[k] for n, k in _places(tree) if isinstance(n[k], dict | list))]
    node = rng.choice(containers)
    if isinstance(node, dict):
        node[rng.choice(KEYS)] = _value(rng)
    else:
        node.insert(rng.randint(0, len(node)), _value(rng))


def _renamed(tree: Any, rng: random.Random) -> None:
    node, key = _place(tree, rng)
    if isinstance(node, dict):
        node[rng.choice([*KEYS, f"{key}s", key.upper(), key[:-1]])] = node.pop(key)


def _swapped(tree: Any, rng: random.Random) -> None:
    (one, i), (other, j) = _place(tree, rng), _place(tree, rng)
    one[i] = copy.deepcopy(other[j])


def _lists(tree: Any, rng: random.Random) -> None:
    """A list longer, shorter or in another order."""
    lists = [n[k] for n, k in _places(tree) if isinstance(n[k], list) and n[k]]
    if lists:
        numbers = rng.choice(lists)
        action = rng.randrange(5)
        if action == 0:
            numbers.pop(rng.randrange(len(numbers)))
        elif action == 1:
            numbers.append(copy.deepcopy(rng.choice(numbers)))
        elif action == 2:
            rng.shuffle(numbers)
        elif action == 3:
            numbers[:] = numbers * rng.choice([2, 10, 100])
        else:
            numbers.clear()


def _larger(tree: Any, rng: random.Random) -> None:
    """A chain of another length, its lists to match."""
    system = tree.get("system")
    if isinstance(system, dict) and isinstance(old := system.get("m"), int):
        new = rng.choice([1, 2, 3, 4, 6, 10, 10, 40, 300])
        system["m"] = new
        for key, numbers in system.items():
            if isinstance(numbers, list) and numbers:
                count = new // 2 if system.get("type") == "collision" else new + len(numbers) - old
                system[key] = (numbers * (max(count, 0) // len(numbers) + 1))[: max(count, 0)]


def _horizon(tree: Any, rng: random.Random) -> None:
    output = tree.get("output")
    if isinstance(output, dict):
        output["until"] = Raw(rng.choice(["1e-9", "0.1", "1", "20", "33.3", "100", "1e3", "1e9"]))


def _tolerance(tree: Any, rng: random.Random) -> None:
    output = tree.get("output")
    if isinstance(output, dict):
        output["tolerance"] = Raw(rng.choice(["0.9", "1e-3", "1e-14", "1e-15", "1e-16", "1e-30", "1e-300"]))


TREE: list[Callable[[Any, random.Random], None]] = [
    _replaced, _number, _number, _removed, _added, _renamed, _swapped, _lists, _larger, _horizon, _tolerance,
]  # fmt: skip


def _in_text(source: str, rng: random.Random) -> bytes:
    lines, content = source.splitlines(keepends=True), bytearray(source.encode())
    k, n = rng.randrange(len(lines)), rng.randrange(len(content))
    match rng.randrange(8):
        case 0:
            lines.insert(k, rng.choice(lines))
        case 1:
            del lines[k]
        case 2:
            rng.shuffle(lines)
        case 3:
            lines.insert(
                k, rng.choice(["\0", "x = ", "[", "[[load]]\n", "a.b.c = 1\n", "]" * 9, "\ufeff", "[" * 10**4])
            )
        case 4:
            return bytes(content[:n])
        case 5:
            for _ in range(rng.choice([1, 3, 30])):
                content[rng.randrange(len(content))] = rng.randrange(256)
            return bytes(content)
        case 6:
            content[n:n] = rng.randbytes(rng.choice([1, 10, 1000]))
            return bytes(content)
        case 7:
            return bytes(content[rng.randrange(len(content)) :] + content[:n])
    return "".join(lines).encode()
