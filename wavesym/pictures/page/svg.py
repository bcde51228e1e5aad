"""A little SVG: elements whose texts and attributes are escaped, with numbers no longer than a picture needs."""

from __future__ import annotations

from html import escape


class Svg(str):
    """Markup. Templates put it in as it is, all other text escaped."""

    __slots__ = ()

    def __html__(self) -> str:
        """As jinja2 asks for it."""
        return str(self)


Attribute = str | float
_NOTHING = Svg()


def element(tag: str, *content: str, **attributes: Attribute) -> Svg:
    """<tag ...>content</tag>; `class_` is the attribute class, `stroke_width` is stroke-width."""
    given = "".join(f' {name.strip("_").replace("_", "-")}="{_attribute(value)}"' for name, value in attributes.items())
    inside = concatenate(*content)
    return Svg(f"<{tag}{given}>{inside}</{tag}>" if inside else f"<{tag}{given}/>")


def concatenate(*content: str) -> Svg:
    """Elements and texts one after another."""
    return Svg("".join(part if isinstance(part, Svg) else escape(part) for part in content))


def line(x1: float, y1: float, x2: float, y2: float, class_: str) -> Svg:
    """From (x1, y1) to (x2, y2)."""
    return element("line", class_=class_, x1=x1, y1=y1, x2=x2, y2=y2)


def polyline(points: list[tuple[float, float]], class_: str) -> Svg:
    """Through all points."""
    return element("path", class_=class_, d="M" + "L".join(f"{short(x)} {short(y)}" for x, y in points))


def upright(points: list[tuple[float, float]], base: float, class_: str) -> Svg:
    """A line from each point up or down to the height of a base."""
    return element("path", class_=class_, d="".join(f"M{short(x)} {short(base)}V{short(y)}" for x, y in points))


def box(x: float, y: float, width: float, height: float, class_: str) -> Svg:
    """A rectangle by its upper left corner."""
    return element("rect", class_=class_, x=x, y=y, width=width, height=height)


def text(x: float, y: float, words: str, anchor: str = "middle", **attributes: Attribute) -> Svg:
    """Words at a place: its "start", "middle" or "end"."""
    return element("text", words, x=x, y=y, text_anchor=anchor, **attributes) if words else _NOTHING


def short(value: float) -> str:
    """A number with a tenth of a pixel at most."""
    return (
        f"{value:.1f}".removesuffix(".0").replace("-0", "0") if abs(value) < 0.05 else f"{value:.1f}".removesuffix(".0")
    )


def _attribute(value: Attribute) -> str:
    return escape(value) if isinstance(value, str) else short(value)
