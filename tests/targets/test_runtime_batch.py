"""Many sets of parameters side by side in C: each is what it is alone, whatever its neighbours are."""

import ctypes

import numpy as np
import pytest

from tests.support.builds import LANGUAGES, STRICT
from tests.support.built_model import written
from tests.targets.test_runtime_c import BUILDING, CASES, drawn, flat
from wavesym.running.toolchain import compiler

COUNT = 97
HARNESS = """
#include "NAME.h"

#include <stdlib.h>

int width(void);
int many(const NAME_parameters *p, size_t sets, int *status, double *estimate, double *out);
int width(void)
{
    return NAME_WIDTH;
}

/* By the batch, then one by one. */
int many(const NAME_parameters *p, size_t sets, int *status, double *estimate, double *out)
{
    NAME_batch *batch = (NAME_batch *)malloc(sizeof *batch);
    NAME_model *model = (NAME_model *)malloc(sizeof *model);
    const NAME_real dtau = NAME_TAU_MAX / COUNT;
    for (size_t set = 0; set < 2 * sets; ++set) {
        const size_t at = set % sets;
        NAME_real sampled[NAME_OUTPUTS * COUNT];
        if (set < sets) {
            if (at % NAME_WIDTH == 0) {
                NAME_build_batch(batch, p + at, sets - at);
            }
            status[set] = batch->status[at % NAME_WIDTH];
            NAME_batch_model(batch, (int)(at % NAME_WIDTH), model);
        } else {
            status[set] = NAME_build(model, p + at);
        }
        estimate[set] = (double)NAME_error_estimate(model);
        NAME_model_sample(model, 0, dtau, COUNT, sampled);
        for (size_t k = 0; k < NAME_OUTPUTS * COUNT; ++k) {
            out[set * NAME_OUTPUTS * COUNT + k] = (double)sampled[k];
        }
    }
    free(batch);
    free(model);
    return 0;
}
"""


class Batch:
    """Sets of parameters, each as a batch and as its own model has it: status, estimate and values of both."""

    def __init__(self, scene, runtime, folder, flags=("-O0",), precision="double", changes=(), of_caller=None):
        """Who calls is compiled with `flags`, too, or with its own."""
        name = scene.name
        flags = [flag.replace("NAME", name.upper()) for flag in flags]
        written(scene, runtime, folder, changes, precision=precision)
        self.real = {"double": np.float64, "single": np.float32}[precision]
        text = HARNESS.replace("NAME_real", {"double": "double", "single": "float"}[precision])
        for kind in ("parameters", "batch", "model", "build", "error"):
            text = text.replace(f"NAME_{kind}", f"{name}_{kind}")
        text = (
            text.replace("NAME_batch", f"{name}_batch")
            .replace("NAME.h", f"{name}.h")
            .replace("NAME_", f"{name.upper()}_")
        )
        (folder / "many.c").write_text(text.replace("COUNT", str(COUNT)))
        always = [*LANGUAGES["c99"], *STRICT, "-fPIC"]
        compiler().run([*always, *flags, "-c", f"{name}.c", "-o", "made.o"], folder)
        compiler().run([*always, *(of_caller or flags), "-shared", "many.c", "made.o", "-o", "many.so"], folder)
        self.library = ctypes.CDLL(str(folder / "many.so"))
        self.width = self.library.width()
        self.outputs = len(scene.outputs)

    def __call__(self, sets):
        given = np.array(sets, self.real)
        status, estimate = np.empty((2, len(given)), np.int32), np.empty((2, len(given)))
        out = np.empty((2, len(given), self.outputs, COUNT))
        where = (ctypes.c_void_p(each.ctypes.data) for each in (status, estimate, out))
        self.library.many(ctypes.c_void_p(given.ctypes.data), ctypes.c_size_t(len(given)), *where)
        return status, estimate, out


def floats(given):
    return [float(value) for value in flat(given)]


def differs(found, fine):
    """How far a batch is from models, relative to the largest value, and how far it may be."""
    _, (estimate, other), (batch, alone) = found
    largest = np.max(np.abs(alone), axis=2)
    error = np.max(np.abs(batch - alone), axis=2)
    assert np.all(error[largest == 0] == 0)
    relative = np.max(error / np.where(largest == 0, 1, largest), axis=1)
    return relative[fine], (estimate + other)[fine]


def check_neighbours(made, sets, bad):
    """Every set is its own model, and `bad` ones among them do not disturb others; which statuses these have."""
    sets = (sets * 3)[: max(made.width, 8) + 3]
    nasty = list(sets)
    nasty[: 2 * len(bad) : 2] = bad
    status, _, out = found = made(nasty)
    assert np.array_equal(status[0], status[1])
    fine = np.flatnonzero(status[1] == 0)
    assert len(fine) == len(sets) - len(bad)
    assert np.isnan(out[:, status[1] != 0]).all()
    error, allowed = differs(found, fine)
    assert np.all(error <= allowed)
    calm = list(sets)
    for place in range(len(bad)):
        calm[2 * place] = sets[1]
    (estimate, _), (without, _) = made(calm)[1:]
    error = np.max(
        np.abs(without - out[0]) / np.maximum(np.max(np.abs(without), axis=2, keepdims=True), 1e-300), axis=2
    )
    assert np.all(np.max(error, axis=1)[fine] <= 2 * estimate[fine])
    return status[0][: 2 * len(bad) : 2].tolist()


def check_estimates(made, sets):
    """Where all sets are the same, a batch looks at outputs where a model does, so that its estimate is the same."""
    for numbers in sets:
        _, (estimate, alone), _ = made([numbers] * made.width)
        assert np.all(np.abs(estimate - alone) <= 1e-6 * alone)


def check_limit(made, kappa):
    """Loads that grow until values can no longer be read: models and batches are refused from the same load on."""
    status, _, _ = made([[*kappa, load, 0, 0, 0, 0, 0] for load in np.geomspace(1e303, 1e305, 48)])
    assert np.array_equal(status[0], status[1])
    assert np.array_equal(np.unique(status), [0, 1])
    assert np.all(np.diff(status[0]) >= 0)


BAD = {
    "building": [[np.nan] * 9, [1, 1e5, 1e5, 1, 1, 1, 1, 1, 1], [1, -1, 1, 1, 1, 1, 1, 1, 1]],
    "ground": [[1, 3e4, 1e5], [0, 1, 1]],
    "drive": [[1, 1, 1, 1, np.nan, 1, 1, 1], [1e5, 1, 1, 1, 1, 1, 1, 1]],
    "collision": [[1, 0, 1, 1], [2e3, 2e3, 1, -1], [1, 1, np.inf, -1e308]],
}


def own(case):
    return [floats(given) for given in drawn(CASES[case][1])]


def check_building(made, sets):
    """All of these; the statuses of bad neighbours."""
    check_estimates(made, sets)
    check_limit(made, [1, 1, 1])
    return check_neighbours(made, sets, BAD["building"])


def test_a_set_is_what_it_is_alone(tmp_path):
    made = Batch(BUILDING, ["kappa", "load"], tmp_path)
    assert made.width == 8
    assert check_building(made, own("building")[:4]) == [1, 2, 1]


def test_what_is_the_caller_s_is_as_large_whatever_the_flags(tmp_path):
    """A program and a library of other flags agree on it."""
    name = BUILDING.name
    written(BUILDING, ["kappa"], tmp_path, parts=["batch"])
    kinds = ("batch", "model", "parameters")
    sizes = "".join(f"size_t {kind}(void); size_t {kind}(void) {{ return sizeof({name}_{kind}); }}\n" for kind in kinds)
    (tmp_path / "sizes.c").write_text(f'#include "{name}.h"\n{sizes}')
    found = []
    for k, flag in enumerate(["-O0", f"-D{name.upper()}_PLAIN", "-march=native"]):
        compiler().run([*LANGUAGES["c99"], flag, "-fPIC", "-shared", "sizes.c", "-o", f"sizes{k}.so"], tmp_path)
        library = ctypes.CDLL(str(tmp_path / f"sizes{k}.so"))
        found.append([library[kind]() for kind in kinds])
    assert found[0] == found[1] == found[2]


@pytest.mark.slow
@pytest.mark.parametrize("of_caller", [["-O1"], ["-O1", "-march=native"]])
@pytest.mark.parametrize("flags", [["-O1", "-DNAME_PLAIN"], ["-O1"], ["-O1", "-march=native"]])
def test_who_calls_may_be_compiled_with_other_flags(flags, of_caller, tmp_path):
    """What is the caller's has one size, however wide the vectors are that its functions use."""
    made = Batch(BUILDING, ["kappa", "load"], tmp_path, flags, of_caller=of_caller)
    assert check_neighbours(made, own("building")[:4], BAD["building"]) == [1, 2, 1]


@pytest.mark.slow
@pytest.mark.parametrize("flags", [("-O3", "-march=native", "-ffp-contract=fast"), ("-O1", "-DNAME_PLAIN")])
@pytest.mark.parametrize("case", CASES)
def test_sets_are_what_they_are_alone(case, flags, tmp_path):
    scene, numbers = CASES[case]
    made = Batch(scene, list(numbers), tmp_path, flags)
    assert made.width == 8
    assert set(check_neighbours(made, own(case), BAD[case])) == {1, 2}


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_in_single_precision_too(case, tmp_path):
    scene, numbers = CASES[case]
    made = Batch(scene, list(numbers), tmp_path, precision="single")
    assert made.width == 16
    calm = [numbers for numbers in own(case) if max(map(abs, numbers)) < 50]
    assert set(check_neighbours(made, calm, BAD[case][:2])) == {1, 2}


@pytest.mark.slow
@pytest.mark.parametrize(
    "change",
    [
        ("all->rates[k], lane) = law->rates[k]", "all->rates[k], 0) = law->rates[k]"),
        ("spread(all + set / SETS, set % SETS, law);", "spread(all + set / SETS, 0, law);"),
        ("CHOSEN(more, size, *most)", "CHOSEN(more, *most, size)"),
        ("AT((x)[(set) / SETS], (set) % SETS)", "AT((x)[(set) / SETS], 0)"),
        ("found |= all[k];", "found &= all[k];"),
    ],
)
def test_a_mistake_is_seen(change, tmp_path):
    change = tuple(text.replace("NAME", "TOWER") for text in change)
    made = Batch(BUILDING, ["kappa", "load"], tmp_path, changes=[change])
    with pytest.raises(AssertionError):
        check_building(made, own("building"))


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("plain", [(), ("-DTOWER_PLAIN",)], ids=["vectors", "plain"])
@pytest.mark.slow
def test_it_compiles_without_a_warning(language, plain, tmp_path):
    written(BUILDING, ["kappa"], tmp_path)
    compiler().run([*LANGUAGES[language], *STRICT, *plain, "-O2", "-c", "tower.c", "-o", "tower.o"], tmp_path)
    assert (tmp_path / "tower.o").stat().st_size > 0
