"""LaTeX read token by token, strictly: what TeX would stop at, or set otherwise than it is meant."""

from __future__ import annotations

import re

_TOKENS = re.compile(r"\\[A-Za-z]+\*?|\\.|.", re.DOTALL)
_DEFINITIONS = re.compile(
    r"^(%.*|\\(providecommand|definecolor|setlength|documentclass|usepackage)\b.*)$", re.MULTILINE
)
_NAMES = re.compile(r"\\(begin|end|label)\{([^}]*)\}(\{[^\n]*\}$)?", re.MULTILINE)
_ALIGNED = {"longtable", "cases", "aligned"}
_TEXT = {"text", "textbf", "textsf", "texttt", "textcolor"}
"""Commands whose argument is text, in formulas too."""
_FORMULA = {"ensuremath", "fitted", "law"}
"""Commands whose argument is a formula."""
_SIGNS = {"frac", "sum", "bar", "dot", "left", "right", "partial", "mathcal", "displaystyle", "in", "leq", "geq"}
"""Commands that stand in formulas alone."""
_IN_TEXT = re.compile(r'[#^_<>|"]')
_IN_FORMULA = re.compile(r'[#"`@?]')


class TexError(AssertionError):
    """What is wrong, and before what."""


def read_tex(page: str) -> None:
    """TexError where a page has what TeX stops at, or sets otherwise than it is meant.

    Groups, formulas and environments close in the order in which they open; each sign is one of the mode in which it
    stands; a formula has no second script at one sign; all is ASCII. Definitions of macros are left out.
    """
    opened: list[str] = ["text"]  # the modes of groups and formulas, and names of environments
    page = page.replace("\\[ ", "$").replace(" \\]", "$")
    page = _NAMES.sub(lambda name: f"\\{name[1]}:{name[2]}\n" if name[1] != "label" else "", _DEFINITIONS.sub("", page))
    tokens = _TOKENS.findall(page)
    pending, scripts, place = "", "", 0

    def refuse(what: str) -> None:
        raise TexError(f"{what}: {''.join(tokens[max(place - 12, 0) : place + 12])!r}")

    while place < len(tokens):
        token = tokens[place]
        mode = next(each for each in reversed(opened) if each in ("text", "formula", "$"))
        place += 1
        if token in ("\\begin", "\\end"):
            end = tokens.index("\n", place)
            name, place = "".join(tokens[place + 1 : end]), end + 1
            if token == "\\begin":
                opened.append(f"environment {name}")
            elif opened.pop() != f"environment {name}":
                refuse(f"{name} ends within what it does not end")
        elif token.startswith("\\") and len(token) > 1:
            word = token[1:]
            pending = "text" if word in _TEXT else "formula" if word in _FORMULA else ""
            if word in _SIGNS and mode == "text":
                refuse(f"{token} in text")
            if word.startswith("text") and word not in {*_TEXT, "textstyle"} and mode != "text":
                refuse(f"{token} in a formula")
        elif token == "{":
            opened.append(pending or ("text" if mode == "text" else "formula"))
            pending = ""
        elif token == "}":
            if opened.pop() not in ("text", "formula") or not opened:
                refuse("} closes something else")
        elif token == "$":
            if opened[-1] == "$":
                opened.pop()
            elif mode == "text":
                opened.append("$")
            else:
                refuse("$ within a formula")
        elif not token.isascii():
            refuse(f"{token} is no ASCII")
        elif token == "%" or (_IN_TEXT if mode == "text" else _IN_FORMULA).match(token):
            refuse(f"{token} in {'text' if mode == 'text' else 'a formula'}")
        elif token == "&" and not any(f"environment {name}" in opened for name in _ALIGNED):
            refuse("& outside of a table")
        if token in ("^", "_"):
            if token in scripts:
                refuse(f"a second {token} at one sign")
            scripts += token
            place = _script_end(tokens, place)
        elif not token.isspace():
            scripts = ""
    if opened != ["text"]:
        refuse(f"ends within {opened[1:]}")


def _script_end(tokens: list[str], place: int) -> int:
    """Where what follows a script begins: its braces close, and what is in them is a formula of its own."""
    if tokens[place] != "{":
        return place + 1
    depth, start = 0, place
    while True:
        depth += {"{": 1, "}": -1}.get(tokens[place], 0)
        place += 1
        if depth == 0:
            break
    read_tex(f"${''.join(tokens[start + 1 : place - 1])}$")
    return place
