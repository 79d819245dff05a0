"""Writes the ONNX files in this folder that are classifiers, with what scikit-learn predicts.

They were written with scikit-learn 1.9.1 and skl2onnx 1.20.0, which tactus does not need, by
``python tests/data/make_classifiers.py`` in a separate environment. Beside each file are samples in
raw units, and the labels that scikit-learn gives them.
"""

from pathlib import Path

import numpy as np
from skl2onnx import to_onnx
from sklearn.neural_network import MLPClassifier
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler

FOLDER = Path(__file__).parent
# Volts, grams and metres.
MIDDLE, SPREAD = np.array([2.5, -300.0, 0.001]), np.array([1.0, 80.0, 0.02])
THREE = np.array(["rest", "tap", "swipe"])


def write(name: str, hidden, activation: str, x, labels, options: dict) -> None:
    network = MLPClassifier(hidden, activation=activation, solver="lbfgs", random_state=1)
    model = make_pipeline(StandardScaler(), network).fit(x, labels)
    made = to_onnx(model, x[:1].astype(np.float32), options={id(network): options})
    (FOLDER / f"{name}.onnx").write_bytes(made.SerializeToString())
    np.savez(FOLDER / f"{name}.npz", x=x, labels=model.predict(x))


def main() -> None:
    rng = np.random.default_rng(1)
    x = MIDDLE + SPREAD * rng.uniform(-1.5, 1.5, (90, 3))
    s = (x - MIDDLE) / SPREAD
    three = (s[:, 0] * s[:, 1] > 0.2).astype(int) + (s[:, 2] > 0.3)
    two = three > 0
    write("sklearn-classes", (6, 4), "relu", x, THREE[three], {})
    write("sklearn-classes-plain", (5,), "tanh", x, three * 10, {"zipmap": False})
    write("sklearn-classes-columns", (5,), "logistic", x, THREE[three], {"zipmap": "columns"})
    write("sklearn-two-classes", (5,), "relu", x, np.where(two, "touch", "none"), {})
    write("sklearn-two-classes-plain", (5,), "tanh", x, two, {"zipmap": False})


if __name__ == "__main__":
    main()
