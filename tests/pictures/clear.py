"""Whether what is written in a picture can be read."""

from matplotlib.figure import Figure


def texts_keep_clear(figure: Figure) -> bool:
    """Whether every text inside the panels of a figure is in its panel and covers no other."""
    figure.canvas.draw()
    renderer = figure.canvas.get_renderer()  # type: ignore[attr-defined]
    for axes in figure.axes:
        inside = axes.get_window_extent(renderer).padded(1)
        boxes = [text.get_window_extent(renderer) for text in axes.texts if text.get_text()]
        for k, box in enumerate(boxes):
            if not (inside.x0 <= box.x0 < box.x1 <= inside.x1 and inside.y0 <= box.y0 < box.y1 <= inside.y1):
                return False
            if any(box.overlaps(other) for other in boxes[:k]):
                return False
    return True
