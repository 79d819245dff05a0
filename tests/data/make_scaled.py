"""Writes the ONNX files in this folder whose networks were trained on scaled data.

They were written with scikit-learn 1.9.1 and skl2onnx 1.20.0, which tactus does not need, by
``python tests/data/make_scaled.py`` in a separate environment. Beside each file are samples in raw
units, and the predictions of scikit-learn for them.
"""

from pathlib import Path

import numpy as np
import onnx
from onnx import helper, numpy_helper
from skl2onnx import to_onnx
from sklearn.compose import TransformedTargetRegressor
from sklearn.neural_network import MLPRegressor
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler

FOLDER = Path(__file__).parent
# Volts, grams and metres.
MIDDLE, SPREAD = np.array([2.5, -300.0, 0.001]), np.array([1.0, 80.0, 0.02])


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


def write(name: str, model: onnx.ModelProto, x, y) -> None:
    (FOLDER / f"{name}.onnx").write_bytes(model.SerializeToString())
    np.savez(FOLDER / f"{name}.npz", x=x, y=y)


def main() -> None:
    rng = np.random.default_rng(1)
    x = MIDDLE + SPREAD * rng.uniform(-1.5, 1.5, (80, 3))
    s = np.tanh((x - MIDDLE) / SPREAD)
    y = np.stack([12 + 8 * s[:, 0] * s[:, 1], 60 + 40 * (s[:, 2] - s[:, 0]) / 2], axis=1)
    for name, kind in (("sklearn-scaled", np.float32), ("sklearn-scaled-double", np.float64)):
        model = pipeline().fit(x, y / 100)
        write(f"{name}-3-5-2", to_onnx(model, x[:1].astype(kind)), x, model.predict(x))
    both = TransformedTargetRegressor(pipeline(), transformer=StandardScaler()).fit(x, y[:, 0])
    inner = to_onnx(both.regressor_, x[:1].astype(np.float32))
    write("sklearn-target-3-5-1", unscaled(inner, both.transformer_), x, both.predict(x))


if __name__ == "__main__":
    main()
