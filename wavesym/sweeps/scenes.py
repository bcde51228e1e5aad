"""Scenes that somebody has made, as the cases of a sweep: they share work as these do, and nothing is stored."""

from __future__ import annotations

import json
from collections.abc import Sequence

from wavesym.progress import progress
from wavesym.results.peaks import Peaks, case_names, varied_paths
from wavesym.scene import Scene
from wavesym.scene.paths import leaves, steps
from wavesym.sweeps.batches import batches
from wavesym.sweeps.dimension import Column, SweepAxis
from wavesym.sweeps.kinds import kind
from wavesym.sweeps.plan import CASE, SweepPlan, output_units
from wavesym.sweeps.single import single
from wavesym.sweeps.values import BatchValues
from wavesym.sweeps.work import ALONE, shared_cases


def peaks_of(scenes: Sequence[Scene], keep: Sequence[str], *, several: bool, at_samples: bool) -> Peaks:
    """The statistics of scenes that `keep` names. WavesymError, with a note of which, as for `summary`."""
    names = case_names(scenes)
    plan = scenes_plan(scenes, keep)
    parts = batches(plan, *(("single", (True,)) if at_samples else kind(plan)))
    values = BatchValues.empty(plan, [(k,) for k in range(len(scenes))])
    with progress("peaks") as line, ALONE:
        for batch in range(len(parts)):
            for group in parts.groups(batch):
                shared = shared_cases(plan, parts, group)
                for place in group:
                    try:
                        values.put(place[0], shared.get(place) or single(plan, scenes[place[0]], at_samples=at_samples))
                    except Exception as error:
                        if several:
                            error.add_note(f"scene {place[0]}: {names[place[0]]}")
                        raise
                    line.count(len(scenes), place[0] + 1, 0)
    arrays = {name: values.arrays[name] if several else values.arrays[name][0] for name in plan.summary}
    return Peaks(names, plan.outputs, several, values.arrays["bound"], arrays)


def scenes_plan(scenes: Sequence[Scene], keep: Sequence[str]) -> SweepPlan:
    """The sweep whose cases are scenes, side by side: its columns are the fields in which they differ."""
    fields = [json.loads(json.dumps(scene.model_dump(), default=str)) for scene in scenes]
    every = [leaves(each) for each in fields]
    varied = varied_paths(every)
    if all(path in each for path in varied for each in every):
        columns = tuple(Column.from_values(path, [each[path] for each in every]) for path in varied)
    else:  # of other forms: whole tables
        tables = dict.fromkeys(str(steps(path)[0]) for path in varied)
        columns = tuple(_whole(table, [each.get(table) for each in fields]) for table in tables)
    columns = columns or (_whole("name", [scene.name for scene in scenes]),)
    outputs = {name: unit for scene in reversed(scenes) for name, unit in output_units(scene).items()}
    outputs = {name: outputs[name] for scene in scenes for name in output_units(scene)}
    clocks = {scene.scale.clock.unit if scene.scale else None for scene in scenes}
    return SweepPlan(
        scenes[0].name,
        fields[0],
        (SweepAxis(CASE, columns),),
        tuple(keep),
        None,
        tuple(outputs),
        tuple(outputs.values()),
        clocks.pop() if len(clocks) == 1 else None,
    )


def _whole(table: str, values: Sequence[object]) -> Column:
    """A column of texts or of whole tables."""
    labels = tuple(map(str, range(len(values))))
    return Column(table, tuple(values), labels, labels)
