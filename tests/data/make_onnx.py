"""Writes the ONNX files in this folder that scikit-learn trained, with what it predicts.

They were written with scikit-learn 1.9.1 and skl2onnx 1.20.0, which tactus does not need, by
``python tests/data/make_onnx.py`` in a separate environment. ``recorded.npz`` has, for each file,
samples in raw units, and the labels or the predictions of scikit-learn for them.
"""

from pathlib import Path

import numpy as np
import onnx
from onnx import helper, numpy_helper
from skl2onnx import to_onnx
from sklearn.compose import TransformedTargetRegressor
from sklearn.neural_network import MLPClassifier, MLPRegressor
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler

FOLDER = Path(__file__).parent
# Volts, grams and metres.
MIDDLE, SPREAD = np.array([2.5, -300.0, 0.001]), np.array([1.0, 80.0, 0.02])
THREE = np.array(["rest", "tap", "swipe"])


def write(name: str, model: onnx.ModelProto, **recorded) -> None:
    (FOLDER / f"{name}.onnx").write_bytes(model.SerializeToString())
    with np.load(FOLDER / "recorded.npz") as found:
        arrays = dict(found) | {f"{name}/{key}": value for key, value in recorded.items()}
    np.savez_compressed(FOLDER / "recorded.npz", **arrays)


def classifier(name: str, hidden, activation: str, x, labels, options: dict) -> None:
    network = MLPClassifier(hidden, activation=activation, solver="lbfgs", random_state=1)
    model = make_pipeline(StandardScaler(), network).fit(x, labels)
    made = to_onnx(model, x[:1].astype(np.float32), options={id(network): options})
    write(name, made, x=x, labels=model.predict(x))


def pipeline():
    network = MLPRegressor(
        hidden_layer_sizes=(5,), activation="tanh", solver="lbfgs", max_iter=300, random_state=1
    )
    return make_pipeline(StandardScaler(), network)


def unscaled(model: onnx.ModelProto, target: StandardScaler) -> onnx.ModelProto:
    """The model of a TransformedTargetRegressor, which skl2onnx does not support.

    It is the model of its regressor, followed by the inverse of its transformer.
    """
    graph = model.graph
    graph.initializer.extend(
        numpy_helper.from_array(values.astype(np.float32), name)
        for name, values in (("target_scale", target.scale_), ("target_mean", target.mean_))
    )
    (output,) = graph.output
    graph.node.extend(
        [
            helper.make_node("Mul", [output.name, "target_scale"], ["scaled"], name="target_Mul"),
            helper.make_node("Add", ["scaled", "target_mean"], ["target"], name="target_Add"),
        ]
    )
    output.name = "target"
    onnx.checker.check_model(model)
    return model


def regressors() -> None:
    """Networks that were trained on scaled data."""
    rng = np.random.default_rng(1)
    x = MIDDLE + SPREAD * rng.uniform(-1.5, 1.5, (80, 3))
    s = np.tanh((x - MIDDLE) / SPREAD)
    y = np.stack([12 + 8 * s[:, 0] * s[:, 1], 60 + 40 * (s[:, 2] - s[:, 0]) / 2], axis=1)
    for name, kind in (("sklearn-scaled", np.float32), ("sklearn-scaled-double", np.float64)):
        model = pipeline().fit(x, y / 100)
        write(f"{name}-3-5-2", to_onnx(model, x[:1].astype(kind)), x=x, y=model.predict(x))
    both = TransformedTargetRegressor(pipeline(), transformer=StandardScaler()).fit(x, y[:, 0])
    inner = to_onnx(both.regressor_, x[:1].astype(np.float32))
    write("sklearn-target-3-5-1", unscaled(inner, both.transformer_), x=x, y=both.predict(x))


def classifiers() -> None:
    rng = np.random.default_rng(1)
    x = MIDDLE + SPREAD * rng.uniform(-1.5, 1.5, (90, 3))
    s = (x - MIDDLE) / SPREAD
    three = (s[:, 0] * s[:, 1] > 0.2).astype(int) + (s[:, 2] > 0.3)
    two = three > 0
    classifier("sklearn-classes", (6, 4), "relu", x, THREE[three], {})
    classifier("sklearn-classes-plain", (5,), "tanh", x, three * 10, {"zipmap": False})
    classifier("sklearn-classes-columns", (5,), "logistic", x, THREE[three], {"zipmap": "columns"})
    classifier("sklearn-two-classes", (5,), "relu", x, np.where(two, "touch", "none"), {})
    classifier("sklearn-two-classes-plain", (5,), "tanh", x, two, {"zipmap": False})


if __name__ == "__main__":
    regressors()
    classifiers()
